// Lists what is registered, after loading the plugin libraries named on the command line.
#include <framework/registry/registry.h>

#include <iostream>

int main(int count, char** files) {
  try {
    talus::Registry registry = talus::Registry::built_in();
    for (int i = 1; i < count; ++i) registry.load_library(files[i]);
    for (const talus::Plugin* plugin : registry.all())
      std::cout << to_string(plugin->declaration.family) << ' ' << plugin->declaration.tag << '('
                << plugin->declaration.inputs.size() << ") from " << plugin->origin << '\n';
  } catch (const talus::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
