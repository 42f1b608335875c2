#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <random>
#include <utility>

#include "core/error.h"
#include "core/ply_file.h"
#include "core/text.h"

namespace underbody::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// What the refusal says; empty when there is none.
std::string refusal(const std::string& bytes) {
    try {
        const PlyFile ply = read_ply(bytes, "a.ply");
        (void)ply_points(ply, "a.ply");
        (void)ply_corners(ply, "a.ply");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

const std::string square =
    "ply\nformat ascii 1.0\ncomment patch 0 base plate\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
    "double z\n"
    "property float pressure\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 10\n1 0 0 20\n1 1 0 30\n0 1 0 40\n3 0 1 2\n3 0 2 3\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(PlyFile, HasItsElementsPropertiesAndComments) {
    const PlyFile ply = read_ply(square, "a.ply");
    EXPECT_THAT(ply.comments, ElementsAre("patch 0 base plate"));
    ASSERT_NE(ply.find("vertex"), nullptr);
    EXPECT_THAT(ply.find("vertex")->find("pressure")->values, ElementsAre(10, 20, 30, 40));
    const PlyProperty* corners = ply_corners(ply, "a.ply");
    ASSERT_NE(corners, nullptr);
    EXPECT_THAT(corners->list_begin, ElementsAre(0, 3, 6));
    EXPECT_THAT(corners->values, ElementsAre(0, 1, 2, 0, 2, 3));
    EXPECT_EQ(ply.find("edge"), nullptr);
}

TEST(PlyFile, MayHaveLineEndsOfWindowsAndBlankLines) {
    std::string windows;
    for (const char c : square) {
        windows += c == '\n' ? "\r\n" : std::string(1, c);
    }
    EXPECT_EQ(refusal(windows), "");
    EXPECT_EQ(refusal(replaced(square, "end_header\n", "end_header\n\n")), "");
    EXPECT_EQ(refusal(square.substr(0, square.size() - 1)), "") << "the last line needs no end";
}

template <class T>
void put(std::string& out, double value, bool swapped) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(value));
    if (swapped) {
        std::reverse(raw.begin(), raw.end());
    }
    out.append(raw.data(), raw.size());
}

TEST(PlyFile, IsTheSameInTextAndInBothByteOrders) {
    static constexpr std::array<std::pair<const char*, void (*)(std::string&, double, bool)>, 8> types{
        {{"char", put<std::int8_t>},
         {"uint8", put<std::uint8_t>},
         {"short", put<std::int16_t>},
         {"uint16", put<std::uint16_t>},
         {"int", put<std::int32_t>},
         {"uint32", put<std::uint32_t>},
         {"float", put<float>},
         {"float64", put<double>}}};
    std::mt19937 random(20);
    for (int run = 0; run < 50; ++run) {
        const std::size_t items = random() % 7;
        std::string header = "element thing " + std::to_string(items) + "\n";
        std::vector<std::size_t> kinds;
        std::vector<bool> lists;
        for (std::size_t p = 0; p < 1 + random() % 5; ++p) {
            kinds.push_back(random() % types.size());
            lists.push_back(random() % 3 == 0);
            header += std::string("property ") + (lists.back() ? "list ushort " : "") + types[kinds.back()].first +
                      " p" + std::to_string(p) + "\n";
        }
        header += "end_header\n";
        std::string text = "ply\nformat ascii 1.0\n" + header;
        std::string little = "ply\nformat binary_little_endian 1.0\n" + header;
        std::string big = "ply\nformat binary_big_endian 1.0\n" + header;
        std::vector<std::vector<double>> expected(kinds.size());
        const bool native_is_big = std::endian::native == std::endian::big;
        for (std::size_t i = 0; i < items; ++i) {
            for (std::size_t p = 0; p < kinds.size(); ++p) {
                const std::size_t values = lists[p] ? random() % 4 : 1;
                if (lists[p]) {
                    text += std::to_string(values) + " ";
                    put<std::uint16_t>(little, static_cast<double>(values), native_is_big);
                    put<std::uint16_t>(big, static_cast<double>(values), !native_is_big);
                }
                for (std::size_t k = 0; k < values; ++k) {
                    const double value = static_cast<double>(random() % 128);  // all types hold it
                    expected[p].push_back(value);
                    text += format_number(value) + " ";
                    types[kinds[p]].second(little, value, native_is_big);
                    types[kinds[p]].second(big, value, !native_is_big);
                }
            }
            text += "\n";
        }
        for (const auto& bytes : {text, little, big}) {
            const PlyFile ply = read_ply(bytes, "a.ply");
            for (std::size_t p = 0; p < kinds.size(); ++p) {
                EXPECT_EQ(ply.elements.at(0).properties.at(p).values, expected[p]) << bytes;
            }
        }
        // Cut anywhere within the values it is refused; only in text can the last number lose a digit unseen.
        if (items > 0 && !expected[0].empty()) {
            for (std::size_t size = 0; size < little.size(); ++size) {
                EXPECT_THROW((void)read_ply(std::string_view(little).substr(0, size), "a.ply"), InputError) << size;
            }
        }
    }
}

TEST(PlyFile, SaysWhatIsWrongAndWhere) {
    EXPECT_THAT(refusal(replaced(square, "1 1 0 30", "1 1 oh 30")), HasSubstr("a.ply:14"));
    EXPECT_THAT(refusal(replaced(square, "1 1 0 30", "1 1 oh 30")), HasSubstr("'oh' is no number"));
    EXPECT_THAT(refusal(replaced(square, "1 1 0 30", "1 1 0")), HasSubstr("'vertex' 3 of 4 has only 3 values"));
    EXPECT_THAT(refusal(replaced(square, "1 1 0 30", "1 1 0 30 7")),
                HasSubstr("has 5 values where its properties take 4"));
    EXPECT_THAT(refusal(replaced(square, "1 1 0 30", "1 nan 0 30")), HasSubstr("'vertex' 3 of 4 has a coordinate"));
    EXPECT_THAT(refusal(replaced(square, "3 0 2 3\n", "3 0 2 300\n")),
                HasSubstr("'face' 2 of 2 names vertex 300, and there are 4"));
    EXPECT_THAT(refusal(replaced(square, "3 0 2 3\n", "3 0 2 -1\n")), HasSubstr("names vertex -1"));
    EXPECT_THAT(refusal(replaced(square, "3 0 2 3\n", "2 0 2\n")), HasSubstr("'face' 2 of 2 has 2 corners"));
    EXPECT_THAT(refusal(replaced(square, "3 0 2 3\n", "-3 0 2 3\n")), HasSubstr("a list of -3 values"));
    EXPECT_THAT(refusal(replaced(square, "3 0 2 3\n", "3 0 2\n")), HasSubstr("the file ends within 'face' 2 of 2"));
    EXPECT_THAT(refusal(replaced(square, "element vertex 4", "element vertex 400000000")),
                HasSubstr("bytes are too few"));
    EXPECT_THAT(refusal(replaced(square, "element vertex 4", "element vertex -4")),
                HasSubstr("'-4' is no number of 'vertex'"));
    EXPECT_THAT(refusal(replaced(square, "property double z", "property real z")), HasSubstr("'real' is no type"));
    EXPECT_THAT(refusal(replaced(square, "property double z", "property double y")), HasSubstr("two properties 'y'"));
    EXPECT_THAT(refusal(replaced(square, "property double z\n", "property list uchar float z\n")), testing::Not(""));
    EXPECT_THAT(refusal(replaced(square, "ascii", "ebcdic")), HasSubstr("binary_big_endian are read"));
    EXPECT_THAT(refusal(replaced(square, "end_header", "end")), HasSubstr("makes no sense"));
    EXPECT_THAT(refusal("ply\nformat ascii 1.0\n"), HasSubstr("ends within its header"));
    EXPECT_THAT(refusal("ply\nend_header\n"), HasSubstr("does not say its format"));
    EXPECT_THAT(refusal(""), HasSubstr("begins with a line 'ply'"));
    EXPECT_THAT(refusal(replaced(square, "vertex_indices", "corners")), HasSubstr("no list 'vertex_indices'"));
    EXPECT_THAT(refusal(replaced(square, "uchar int", "float int")),
                HasSubstr("the length of a list is a whole number"));
}

TEST(PlyFile, OfPointsAloneHasNoCorners) {
    const std::string points =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 "
        "2 3\n";
    const PlyFile ply = read_ply(points, "a.ply");
    EXPECT_EQ(ply_points(ply, "a.ply").z.at(0), 3);
    EXPECT_EQ(ply_corners(ply, "a.ply"), nullptr);
}

}  // namespace
}  // namespace underbody::core
