// Text of any origin as UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace underbody::core {

bool is_utf8(std::string_view text);

/// The text when it is UTF-8; otherwise each byte from 0x80 on is taken as a character of Latin-1, the code of old
/// Western exports. A text of another code (GBK, Shift JIS) becomes other letters, but a valid text.
std::string as_utf8(std::string_view text);

}  // namespace underbody::core
