// The bundled template, as cmake/page.cmake embeds it; empty where it was not bundled.
#pragma once

#include <string_view>

namespace talus {

extern const std::string_view page_template;

}  // namespace talus
