#include "postproc/importers/fluent_text.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace underbody::postproc {

namespace {

constexpr std::array<unsigned char, 256> digit_table() {
    std::array<unsigned char, 256> table{};
    for (auto& entry : table) {
        entry = 255;
    }
    for (unsigned char i = 0; i < 10; ++i) {
        table[static_cast<unsigned char>('0' + i)] = i;
    }
    for (unsigned char i = 0; i < 6; ++i) {
        table[static_cast<unsigned char>('a' + i)] = static_cast<unsigned char>(10 + i);
        table[static_cast<unsigned char>('A' + i)] = static_cast<unsigned char>(10 + i);
    }
    return table;
}
constexpr auto digits = digit_table();

bool is_space(char c) { return static_cast<unsigned char>(c) <= ' '; }

std::string shown(int c) {
    if (c < 0) {
        return "the end of the file";
    }
    if (c > ' ' && c < 127) {
        return std::string("'") + static_cast<char>(c) + "'";
    }
    return "byte " + std::to_string(c);
}

constexpr std::string_view end_words = "End of Binary Section";

}  // namespace

void FluentText::fail(const std::string& what) const {
    throw core::InputError(
        "format", (section_ != 0 ? "section " + std::to_string(section_) + ": " : std::string()) + what, in_.place());
}

void FluentText::skip_space() {
    for (;;) {
        const char* p = in_.here();
        while (p != in_.end() && is_space(*p)) {
            ++p;
        }
        in_.move_to(p);
        if (p != in_.end() || !in_.ensure(1)) {
            return;
        }
    }
}

int FluentText::next() {
    skip_space();
    return in_.peek();
}

void FluentText::expect(char c) {
    const int found = next();
    if (found != static_cast<unsigned char>(c)) {
        fail(std::string("expected '") + c + "', found " + shown(found));
    }
    in_.get();
}

bool FluentText::accept(char c) {
    if (next() != static_cast<unsigned char>(c)) {
        return false;
    }
    in_.get();
    return true;
}

std::uint64_t FluentText::number(int base) {
    const int found = next();
    if (found < 0 || digits[static_cast<std::size_t>(found)] >= base) {
        fail("expected a number, found " + shown(found));
    }
    std::uint64_t value = 0;
    for (;;) {
        const int c = in_.peek();
        if (c < 0 || digits[static_cast<std::size_t>(c)] >= base) {
            return value;
        }
        if (value > (std::uint64_t{1} << 56)) {
            fail("a number with too many digits");
        }
        value = value * static_cast<std::uint64_t>(base) + digits[static_cast<std::size_t>(c)];
        in_.get();
    }
}

std::uint32_t FluentText::fast_hex() {
    const char* p = in_.here();
    const char* const end = in_.end();
    while (p != end && is_space(*p)) {
        ++p;
    }
    const char* const first = p;
    std::uint64_t value = 0;
    while (p != end) {
        const unsigned char digit = digits[static_cast<unsigned char>(*p)];
        if (digit > 15) {
            break;
        }
        value = (value << 4) | digit;
        ++p;
    }
    if (p == first || p - first > 8 || p == end) {
        // At the window's end, or not a number: the careful way decides.
        value = number(16);
        if (value > 0xffffffffULL) {
            fail("a number that is too large: " + std::to_string(value));
        }
        return static_cast<std::uint32_t>(value);
    }
    in_.move_to(p);
    return static_cast<std::uint32_t>(value);
}

double FluentText::real() {
    skip_space();
    in_.ensure(64);
    const char* first = in_.here();
    if (first != in_.end() && *first == '+') {
        ++first;
    }
    double value = 0;
    const auto [rest, error] = fast_float::from_chars(first, in_.end(), value);
    if (error == std::errc::invalid_argument) {
        fail("expected a number, found " + shown(in_.peek()));
    }
    in_.move_to(rest);
    return value;
}

void FluentText::reals(double* out, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
        out[i] = real();
    }
}

std::vector<std::uint64_t> FluentText::numbers(int base) {
    std::vector<std::uint64_t> result;
    expect('(');
    while (!accept(')')) {
        if (result.size() > 64) {
            fail("too many numbers in a section's header");
        }
        result.push_back(number(base));
    }
    return result;
}

std::vector<std::string> FluentText::words() {
    std::vector<std::string> result;
    expect('(');
    while (!accept(')')) {
        std::string word;
        bool quoted = false;
        for (;;) {
            const int c = in_.peek();
            if (c < 0) {
                fail("the file ends within a section's header");
            }
            if (!quoted && (is_space(static_cast<char>(c)) || c == ')' || c == '(')) {
                break;
            }
            in_.get();
            if (c == '"') {
                quoted = !quoted;
            } else {
                word += static_cast<char>(c);
            }
            if (word.size() > 4096 || result.size() > 4096) {
                fail("a section's header that is too long");
            }
        }
        if (word.empty() && in_.peek() == '(') {
            in_.get();
            inside(0);
        }
        result.push_back(std::move(word));
    }
    return result;
}

std::string FluentText::inside(std::size_t most) {
    std::string text;
    int depth = 1;
    bool quoted = false;
    bool escaped = false;
    while (in_.ensure(1)) {
        const char* const first = in_.here();
        const char* p = first;
        for (; p != in_.end() && depth > 0; ++p) {
            const char c = *p;
            if (quoted) {
                quoted = escaped || c != '"';
                escaped = !escaped && c == '\\';
            } else if (c == '"') {
                quoted = true;
            } else if (c == '(') {
                ++depth;
            } else if (c == ')') {
                --depth;
            }
        }
        const auto part = static_cast<std::size_t>(p - first);
        text.append(first, std::min(part, most - std::min(most, text.size())));
        in_.move_to(p);
        if (depth == 0) {
            if (text.size() < most && !text.empty()) {
                text.pop_back();  // the closing bracket
            }
            return text;
        }
    }
    fail(quoted ? "the file ends within a quoted text" : "the file ends before the section's closing bracket");
}

bool FluentText::section_ahead() {
    skip_space();
    in_.ensure(8);
    const char* p = in_.here();
    if (p == in_.end() || *p != '(') {
        return p == in_.end();
    }
    const char* const first = ++p;
    while (p != in_.end() && digits[static_cast<unsigned char>(*p)] < 10) {
        ++p;
    }
    return p != first && p != in_.end() && (is_space(*p) || *p == '(' || *p == '"');
}

std::string FluentText::comment() {
    skip_space();
    std::string text;
    if (in_.peek() == '"') {
        return inside(512);
    }
    // Without quotes brackets need not match: a line that ends with one, before what looks like a section, is the end.
    for (int depth = 0;;) {
        const int c = in_.get();
        if (c < 0) {
            fail("the file ends within a comment");
        }
        depth += c == '(' ? 1 : 0;
        if (c == ')' && depth-- == 0) {
            return text;
        }
        if (c == '\n') {
            while (!text.empty() && is_space(text.back())) {
                text.pop_back();
            }
            if (!text.empty() && text.back() == ')' && section_ahead()) {
                return text;
            }
        }
        if (text.size() < 512 || c == ')') {
            text += static_cast<char>(c);
        }
    }
}

void FluentText::skip_plain_body() {
    while (in_.ensure(1)) {
        const void* found = std::memchr(in_.here(), ')', static_cast<std::size_t>(in_.end() - in_.here()));
        if (found != nullptr) {
            in_.move_to(static_cast<const char*>(found));
            close_plain_body();
            return;
        }
        in_.move_to(in_.end());
    }
    fail("the file ends within the section");
}

void FluentText::close_plain_body() {
    const int found = next();
    if (found != ')') {
        fail("the section holds more than its header says: expected ')', found " + shown(found));
    }
    in_.get();
    while (accept('(')) {  // foamMeshToFluent leaves an empty list there
        expect(')');
    }
    expect(')');
}

void FluentText::close_binary_body(std::uint64_t index) {
    int c = next();
    while (c == ')') {
        in_.get();
        c = next();
    }
    in_.ensure(end_words.size() + 64);
    const std::string_view rest(in_.here(), static_cast<std::size_t>(in_.end() - in_.here()));
    if (!rest.starts_with(end_words)) {
        fail(
            "the end mark of the binary body is not where the header puts it: bytes were lost or added "
            "(a transfer in text mode does that), or the counts are wrong");
    }
    in_.move_to(in_.here() + end_words.size());
    const std::uint64_t found = number(10);
    if (found != index) {
        fail("the end mark names section " + std::to_string(found));
    }
    expect(')');
    accept(')');
}

void FluentText::skip_binary_body(std::uint64_t index) {
    const std::string number_text = std::to_string(index);
    while (in_.ensure(end_words.size())) {
        const char* p = in_.here();
        for (;;) {
            const auto left = static_cast<std::size_t>(in_.end() - p);
            p = left < end_words.size()
                    ? nullptr
                    : static_cast<const char*>(::memmem(p, left, end_words.data(), end_words.size()));
            if (p == nullptr) {
                in_.move_to(in_.end() - (end_words.size() - 1));
                break;
            }
            in_.move_to(p);
            in_.ensure(end_words.size() + 64);
            p = in_.here() + end_words.size();
            const char* q = p;
            while (q != in_.end() && *q == ' ') {
                ++q;
            }
            if (std::string_view(q, static_cast<std::size_t>(in_.end() - q)).starts_with(number_text + ")")) {
                close_binary_body(index);
                return;
            }
        }
    }
    fail("the file ends within the binary body");
}

}  // namespace underbody::postproc
