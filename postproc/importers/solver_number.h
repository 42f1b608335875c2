// Numbers as solvers write them, faster than a parser for any number: text to double, hexadecimal words to integers.
#pragma once

#include <fast_float/fast_float.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace underbody::postproc {

/// 8 digits at once (Lemire's way).
inline bool eight_digits(const char* p, std::uint64_t& value) {
    std::uint64_t v = 0;
    std::memcpy(&v, p, 8);
    if (((v & 0xF0F0F0F0F0F0F0F0ULL) | (((v + 0x0606060606060606ULL) & 0xF0F0F0F0F0F0F0F0ULL) >> 4)) !=
        0x3333333333333333ULL) {
        return false;
    }
    v -= 0x3030303030303030ULL;
    v = (v * 10) + (v >> 8);
    value = (((v & 0x000000FF000000FFULL) * 0x000F424000000064ULL) +
             (((v >> 16) & 0x000000FF000000FFULL) * 0x0000271000000001ULL)) >>
            32;
    return true;
}

inline constexpr std::array<double, 23> powers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Numbers as solvers write them (at most 53 bits of digits, small exponents) are exact in one operation
/// (Clinger 1990); everything else goes to fast_float. Returns the end of the number, nullptr if there is none.
inline const char* parse_number(const char* start, const char* end, double& out) {
    const char* p = start;
    if (end - p < 64) {  // near the end of the text: no reading ahead
        const auto result = fast_float::from_chars(*p == '+' ? p + 1 : p, end, out);
        return result.ec == std::errc() ? result.ptr : nullptr;
    }
    const bool negative = *p == '-';
    p += negative || *p == '+' ? 1 : 0;
    const char* digits = p;
    std::uint64_t mantissa = 0;
    while (static_cast<unsigned char>(*p - '0') < 10) {
        mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
        if (++p - digits > 18) {
            break;
        }
    }
    std::int64_t exponent = 0;
    auto count = p - digits;
    if (*p == '.') {
        const char* fraction = ++p;
        std::uint64_t eight = 0;
        if (count < 10 && eight_digits(p, eight)) {
            mantissa = mantissa * 100000000 + eight;
            p += 8;
        }
        while (static_cast<unsigned char>(*p - '0') < 10 && p - fraction < 18) {
            mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
            ++p;
        }
        exponent = fraction - p;
        count += p - fraction;
    }
    if (count == 0) {
        return nullptr;
    }
    bool simple = count <= 18 && static_cast<unsigned char>(*p - '0') >= 10;
    if (simple && (*p | 0x20) == 'e') {
        const char* q = p + 1;
        const bool minus = *q == '-';
        q += minus || *q == '+' ? 1 : 0;
        int power = 0;
        const char* power_digits = q;
        while (static_cast<unsigned char>(*q - '0') < 10 && q - power_digits < 5) {
            power = power * 10 + (*q++ - '0');
        }
        simple = q > power_digits && q - power_digits < 5;
        exponent += minus ? -power : power;
        p = q;
    }
    if (!simple || mantissa > (std::uint64_t{1} << 53) || exponent < -22 || exponent > 22) {
        const auto result = fast_float::from_chars(*start == '+' ? start + 1 : start, end, out);
        return result.ec == std::errc() ? result.ptr : nullptr;
    }
    const auto value = static_cast<double>(mantissa);
    const double scaled = exponent < 0 ? value / powers[static_cast<std::size_t>(-exponent)]
                                       : value * powers[static_cast<std::size_t>(exponent)];
    out = negative ? -scaled : scaled;
    return p;
}

/// The hexadecimal word at `p`, which ends at white space or a bracket within its first 9 bytes; `p` moves behind it.
/// 9 bytes must be readable at `p`. False when it is no such word: `p` stays.
inline bool parse_hex(const char*& p, std::uint32_t& out) {
    constexpr std::uint64_t ones = 0x0101010101010101ULL;
    constexpr std::uint64_t highs = 0x8080808080808080ULL;
    std::uint64_t x = 0;
    std::memcpy(&x, p, 8);
    const std::uint64_t ends = (~((x & ~highs) + ones * 0x56) & ~x) & highs;  // bytes below '*': blanks and brackets
    const int length = ends == 0 ? 8 : __builtin_ctzll(ends) / 8;
    if (length == 0 || (length == 8 && static_cast<unsigned char>(p[8]) >= '*')) {
        return false;
    }
    // The digits to the top, zeros below them.
    x = length == 8 ? x : (x << (64 - 8 * length)) | ((ones * 0x30) >> (8 * length));
    const std::uint64_t small = x | (ones * 0x20);
    const std::uint64_t above_9 = small + ones * 0x46;
    const std::uint64_t from_0 = small + ones * 0x50;
    const std::uint64_t from_a = small + ones * 0x1f;
    const std::uint64_t above_f = small + ones * 0x19;
    if (((x | ~from_0 | above_f | (above_9 & ~from_a)) & highs) != 0) {
        return false;
    }
    std::uint64_t v = (x & (ones * 0x0f)) + ((x >> 6) & ones) * 9;
    v = ((v << 4) | (v >> 8)) & 0x00ff00ff00ff00ffULL;
    v = ((v << 8) | (v >> 16)) & 0x0000ffff0000ffffULL;
    v = ((v << 16) | (v >> 32)) & 0xffffffffULL;
    out = static_cast<std::uint32_t>(v);
    p += length;
    return true;
}

}  // namespace underbody::postproc
