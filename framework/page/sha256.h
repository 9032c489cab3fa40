// The SHA-256 digest of a text (FIPS 180-4), as `sha256sum` prints it: so that a page can say which
// files it was made from.
#pragma once

#include <string>
#include <string_view>

namespace talus {

std::string sha256(std::string_view text);

}  // namespace talus
