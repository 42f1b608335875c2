#include <gtest/gtest.h>

#include "core/utf8.h"

namespace underbody::core {
namespace {

TEST(Utf8, IsKeptAndLatinOneBecomesIt) {
    for (const char* text : {"", "hull", "Fl\u00fcgel", "\u7ffc", "\U0001F6A2"}) {
        EXPECT_TRUE(is_utf8(text)) << text;
        EXPECT_EQ(as_utf8(text), text);
    }
    EXPECT_EQ(as_utf8("Fl\xFCgel"), "Fl\u00fcgel");
    EXPECT_EQ(as_utf8("\xB0"), "\u00b0");
}

TEST(Utf8, HasNoOverlongFormsSurrogatesAndCutCharacters) {
    for (const char* text : {"\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80",
                             "\xE7\xBF", "\xC3", "\x80"}) {
        EXPECT_FALSE(is_utf8(text));
        EXPECT_TRUE(is_utf8(as_utf8(text)));
    }
}

TEST(Utf8, AnyBytesBecomeAValidText) {
    std::string all;
    for (int byte = 255; byte > 0; --byte) {
        all += static_cast<char>(byte);
        EXPECT_TRUE(is_utf8(as_utf8(all)));
    }
}

}  // namespace
}  // namespace underbody::core
