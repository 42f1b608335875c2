#include "postproc/importers/fluent/fluent_text.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "core/parallel.h"
#include "postproc/importers/solver_number.h"

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
constexpr const char* decimal_comma = " (a decimal comma? the file was rewritten by a program with another language)";

}  // namespace

void FluentText::fail(const std::string& what) const {
    throw core::InputError(
        "format", (section_ != 0 ? "section " + std::to_string(section_) + ": " : std::string()) + what, in_.place());
}

void FluentText::skip_byte_order_mark() {
    if (in_.ensure(3) && std::memcmp(in_.here(), "\xEF\xBB\xBF", 3) == 0) {
        in_.skip(3);
    }
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

std::uint32_t FluentText::hexadecimal() {
    const std::uint64_t value = number(16);
    if (value > 0xffffffffULL) {
        fail("a number that is too large: " + std::to_string(value));
    }
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
    if (rest != in_.end() && !is_space(*rest) && *rest != ')') {
        fail("expected the end of a number, found " + shown(in_.peek()) + (*rest == ',' ? decimal_comma : ""));
    }
    return value;
}

std::vector<std::string_view> FluentText::pieces(bool& bracket) {
    in_.ensure(ByteStream::largest_window);
    const char* const first = in_.here();
    const auto left = static_cast<std::size_t>(in_.end() - first);
    const bool all = left < ByteStream::largest_window;  // the file ends there
    // A part of the window at a time: the numbers of all of it would take more memory than the mesh of a small case.
    const std::size_t length = std::min(left, ByteStream::largest_window);
    const auto* const found = static_cast<const char*>(std::memchr(first, ')', length));
    bracket = found != nullptr;
    const char* last = bracket ? found : first + length;
    while (!bracket && !all && last != first && !is_space(last[-1])) {
        --last;
    }
    std::vector<std::string_view> result;
    for (const char* p = first; p != last;) {
        constexpr std::ptrdiff_t piece = 64 * 1024;
        const char* q = last - p > piece + piece / 2 ? p + piece : last;
        while (q != last && !is_space(*q)) {
            ++q;
        }
        result.emplace_back(p, static_cast<std::size_t>(q - p));
        p = q;
    }
    return result;
}

namespace {

/// The hexadecimal number at `p`, up to a blank or `end`; where it ends, nullptr: it is none of 32 bits.
const char* parse_word(const char* p, const char* end, std::uint32_t& out) {
    if (end - p > 8 && parse_hex(p, out)) {
        return p;
    }
    const char* const start = p;
    std::uint64_t value = 0;
    for (; p != end && digits[static_cast<unsigned char>(*p)] < 16 && value <= 0xffffffffULL; ++p) {
        value = value << 4 | digits[static_cast<unsigned char>(*p)];
    }
    out = static_cast<std::uint32_t>(value);
    return p == start || value > 0xffffffffULL ? nullptr : p;
}

const char* parse_word(const char* p, const char* end, double& out) { return parse_number(p, end, out); }

/// The numbers of one piece; where it fails, if it does.
template <typename Number>
const char* numbers_of(std::string_view piece, Buffer<Number>& out) {
    out.grow_to(piece.size() / 2 + 1);
    Number* to = out.data();
    const char* p = piece.data();
    const char* const end = p + piece.size();
    const char* failed = nullptr;
    for (;;) {
        while (p != end && is_space(*p)) {
            ++p;
        }
        if (p == end) {
            break;
        }
        const char* const next = parse_word(p, end, *to);
        if (next == nullptr || (next != end && !is_space(*next))) {
            failed = p;
            break;
        }
        p = next;
        ++to;
    }
    out.grow_to(static_cast<std::size_t>(to - out.data()));
    return failed;
}

/// Every piece, on all threads; the first place that failed, or nullptr.
template <typename Number>
const char* parse_all(const std::vector<std::string_view>& pieces, std::vector<Buffer<Number>>& lists) {
    lists.resize(std::max(lists.size(), pieces.size()));
    std::vector<const char*> failed(pieces.size());
    core::parallel_for(pieces.size(), [&](std::size_t i) { failed[i] = numbers_of(pieces[i], lists[i]); });
    for (std::size_t i = pieces.size(); i < lists.size(); ++i) {
        lists[i].grow_to(0);
    }
    const auto first = std::find_if(failed.begin(), failed.end(), [](const char* p) { return p != nullptr; });
    return first == failed.end() ? nullptr : *first;
}

}  // namespace

void FluentText::fail_at(const char* place) {
    in_.move_to(place);
    const char* p = place;
    while (p != in_.end() && digits[static_cast<unsigned char>(*p)] < 16) {
        ++p;
    }
    in_.move_to(p);  // behind the digits that are fine
    const int found = in_.peek();
    if (p - place > 8 || found < 0 || is_space(static_cast<char>(found))) {
        in_.move_to(place);
        fail("a number that is too large");
    }
    fail("expected a number, found " + shown(found) + (found == ',' ? decimal_comma : ""));
}

bool FluentText::hexadecimals(std::vector<Buffer<std::uint32_t>>& lists) {
    bool bracket = false;
    const auto texts = pieces(bracket);
    if (texts.empty() && !bracket) {
        fail(in_.at_end() ? "expected a number, found the end of the file" : "a number with too many digits");
    }
    if (const char* failed = parse_all(texts, lists); failed != nullptr) {
        fail_at(failed);
    }
    if (!texts.empty()) {
        in_.move_to(texts.back().data() + texts.back().size());
    }
    return !bracket;
}

void FluentText::reals(double* out, std::uint64_t count) {
    constexpr std::uint64_t worth_it = 256;
    while (count > worth_it) {
        bool bracket = false;
        const auto texts = pieces(bracket);
        const char* const failed = parse_all(texts, parts_);
        std::uint64_t found = 0;
        for (const auto& part : parts_) {
            found += part.size();
        }
        // Anything odd is left to the careful way below, which says what and where.
        if (failed != nullptr || found == 0 || found > count || (bracket && found < count)) {
            break;
        }
        for (const auto& part : parts_) {
            out = std::copy_n(part.data(), part.size(), out);
        }
        count -= found;
        in_.move_to(texts.back().data() + texts.back().size());
    }
    for (std::uint64_t i = 0; i < count; ++i) {
        out[i] = real();
    }
}

void HexWords::advance() {
    while (at_ == end_) {
        while (list_ < lists_.size() && lists_[list_].empty()) {
            ++list_;
        }
        if (list_ == lists_.size()) {
            if (!more_) {
                text_.fail("the section ends before all that its header announces");
            }
            more_ = text_.hexadecimals(lists_);
            list_ = 0;
            continue;
        }
        at_ = lists_[list_].begin();
        end_ = lists_[list_].end();
        ++list_;
    }
}

void HexWords::finish() const {
    const bool left = std::any_of(lists_.begin() + static_cast<std::ptrdiff_t>(std::min(list_, lists_.size())),
                                  lists_.end(), [](const auto& list) { return !list.empty(); });
    if (at_ != end_ || left) {
        text_.fail("the section holds more than its header says");
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

std::vector<std::uint64_t> FluentText::header(int base, std::size_t least) {
    auto result = numbers(base);
    if (result.size() < least) {
        fail("a header with too few numbers");
    }
    return result;
}

void FluentText::machine() {
    constexpr std::uint64_t little_endian = 60;
    const auto sizes = numbers(10);
    expect(')');
    swap_ = !sizes.empty() && sizes[0] != little_endian;
}

void FluentText::binary_reals(double* out, std::uint64_t count, std::size_t size) {
    if (size == sizeof(double)) {
        in_.read(out, count * sizeof(double));
        for (std::uint64_t i = 0; i < count && swap_; ++i) {
            out[i] = std::bit_cast<double>(__builtin_bswap64(std::bit_cast<std::uint64_t>(out[i])));
        }
        return;
    }
    std::array<std::uint32_t, 16384> raw;
    for (std::uint64_t done = 0; done < count;) {
        const std::size_t some = std::min<std::uint64_t>(raw.size(), count - done);
        binary_integers(raw.data(), some);
        for (std::size_t i = 0; i < some; ++i) {
            out[done + i] = std::bit_cast<float>(raw[i]);
        }
        done += some;
    }
}

void FluentText::binary_integers(std::uint32_t* out, std::size_t count) {
    in_.read(out, count * sizeof(std::uint32_t));
    if (swap_) {
        std::transform(out, out + count, out, [](std::uint32_t v) { return __builtin_bswap32(v); });
    }
}

std::uint32_t FluentText::binary_integer() {
    std::uint32_t value = 0;
    in_.ensure(sizeof(value));
    if (static_cast<std::size_t>(in_.end() - in_.here()) >= sizeof(value)) {
        std::memcpy(&value, in_.here(), sizeof(value));
        in_.move_to(in_.here() + sizeof(value));
    } else {
        in_.read(&value, sizeof(value));
    }
    return swap_ ? __builtin_bswap32(value) : value;
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

void FluentText::skip_section(std::uint64_t index, bool binary) {
    if (!binary) {
        inside(0);
        return;
    }
    if (next() == '(') {
        in_.get();
        inside(0);
    }
    if (!accept(')')) {
        expect('(');
        skip_binary_body(index);
    }
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

std::vector<std::string> listed_sections(const std::map<std::uint64_t, int>& skipped) {
    std::vector<std::string> result;
    for (const auto& [index, times] : skipped) {
        result.push_back(std::to_string(index) + (times > 1 ? " (" + std::to_string(times) + " times)" : ""));
    }
    return result;
}

}  // namespace underbody::postproc
