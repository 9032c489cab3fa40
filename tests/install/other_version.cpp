// What a plugin library built for another version of the plugin interface looks like from outside.
extern "C" int talus_plugin_interface() { return 999; }
extern "C" void talus_plugin_register(void*, const char*) {
  __builtin_trap();
}  // never to be called
