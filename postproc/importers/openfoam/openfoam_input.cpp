#include "postproc/importers/openfoam/openfoam_input.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "core/inputs.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

bool is_space(int c) { return c >= 0 && c <= ' '; }
bool is_mark(int c) { return c == '(' || c == ')' || c == '{' || c == '}' || c == '[' || c == ']' || c == ';'; }

fs::path present(const fs::path& path) {
    std::error_code error;
    fs::path packed = path;
    packed += ".gz";
    core::note_presence(path);
    core::note_presence(packed);
    return !fs::is_regular_file(path, error) && fs::is_regular_file(packed, error) ? packed : path;
}

constexpr std::size_t longest_word = 65536;

}  // namespace

FoamInput::FoamInput(const fs::path& path) : file_(present(path)), in_(&file_) { read_header(); }

bool FoamInput::exists(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(present(path), error);
}

void FoamInput::fail(const std::string& what) const { throw core::InputError("format", what, place()); }

/// The next character that is neither blank nor comment, not taken; -1 at the end.
int FoamInput::next() {
    for (;;) {
        const int c = in_->peek();
        if (is_space(c)) {
            in_->get();
            continue;
        }
        if (c < 0 && !pushed_.empty()) {
            pop();
            continue;
        }
        if (expanding_ && ((c == '$' && substitute()) || (c == '#' && include()))) {
            continue;
        }
        if (c != '/' || !in_->ensure(2)) {
            return c;
        }
        const char second = in_->here()[1];
        if (second == '/') {
            for (int d = in_->get(); d >= 0 && d != '\n';) {
                d = in_->get();
            }
        } else if (second == '*') {
            in_->skip(2);
            for (int before = 0, d = in_->get(); d >= 0 && !(before == '*' && d == '/');) {
                before = d;
                d = in_->get();
            }
        } else {
            return c;
        }
    }
}

std::string FoamInput::token() {
    int c = next();
    quoted_ = c == '"';
    if (c < 0) {
        return {};
    }
    std::string word;
    if (is_mark(c)) {
        word += static_cast<char>(in_->get());
        return word;
    }
    if (c == '"') {
        in_->get();
        for (c = in_->get(); c != '"'; c = in_->get()) {
            if (c < 0 || word.size() > longest_word) {
                fail("the file ends within a quoted text");
            }
            word += static_cast<char>(c);
        }
        return word;
    }
    if (c == '#' && in_->ensure(2) && in_->here()[1] == '{') {
        return code();
    }
    for (; c >= 0 && !is_space(c) && !is_mark(c) && c != '"'; c = in_->peek()) {
        word += static_cast<char>(in_->get());
        if (word.size() > longest_word) {
            fail("a word that is too long");
        }
    }
    return word;
}

/// "#{ ... #}" as one word, whatever stands in it; the code itself is passed over.
std::string FoamInput::code() {
    in_->skip(2);
    for (int before = 0, c = in_->get(); !(before == '#' && c == '}');) {
        if (c < 0) {
            fail("the file ends within code");
        }
        before = c;
        c = in_->get();
    }
    return "#{";
}

void FoamInput::expect(const std::string& wanted) {
    const std::string found = token();
    if (found != wanted) {
        fail("expected '" + wanted + "', found " +
             (found.empty() ? "the end of the file" : "'" + found.substr(0, 40) + "'"));
    }
}

bool FoamInput::accept(char c) {
    if (next() != static_cast<unsigned char>(c)) {
        return false;
    }
    in_->get();
    return true;
}

bool FoamInput::at_letter() { return std::isalpha(next()) != 0; }

void FoamInput::skip_list_type() {
    if (const int c = next(); c < '0' || c > '9') {
        token();
    }
}

double FoamInput::number() {
    const int first = next();
    if (expanding_ && (first == '$' || first == '#')) {
        give_up_at_macro(token());
    }
    in_->ensure(64);
    double value = 0;
    const auto [rest, error] = fast_float::from_chars(in_->here(), in_->end(), value);
    if (error == std::errc::invalid_argument) {
        fail("expected a number, found '" + token().substr(0, 40) + "'");
    }
    in_->move_to(rest);
    return value;
}

std::uint32_t FoamInput::label() {
    next();
    in_->ensure(16);
    const char* p = in_->here();
    std::uint64_t value = 0;
    while (p != in_->end() && static_cast<unsigned char>(*p - '0') < 10 && value < 0xffffffffULL) {
        value = value * 10 + static_cast<std::uint64_t>(*p++ - '0');
    }
    if (p == in_->here() || value >= 0x7fffffffULL) {
        fail("expected a whole number from 0 to 2147483646, found '" + token().substr(0, 40) + "'");
    }
    in_->move_to(p);
    return static_cast<std::uint32_t>(value);
}

std::uint64_t FoamInput::count() {
    next();
    if (const int c = in_->peek(); c < '0' || c > '9') {
        fail("expected a number of items, found " +
             (c < 0 ? "the end of the file" : "'" + token().substr(0, 40) + "'"));
    }
    return label();
}

void FoamInput::read_header() {
    if (next() < 0) {
        fail("the file is empty");
    }
    if (!in_->ensure(8) || std::memcmp(in_->here(), "FoamFile", 8) != 0) {
        fail("expected the header FoamFile");
    }
    token();
    expect("{");
    for (std::string key = token(); key != "}"; key = token()) {
        if (key.empty()) {
            fail("the file ends within its header");
        }
        const std::string text = token();
        if (key == "class") {
            class_ = text;
        } else if (key == "format") {
            binary_ = text == "binary";
        } else if (key == "arch") {
            swapped_ = text.find("MSB") != std::string::npos;
            label_bytes_ = text.find("label=64") != std::string::npos ? 8 : 4;
            scalar_bytes_ = text.find("scalar=32") != std::string::npos ? 4 : 8;
        }
        if (text != ";") {
            skip_entry();
        }
    }
}

void FoamInput::check_room(std::uint64_t count, std::uint64_t bytes) const {
    if (count > in_->most_left() / bytes + 1) {
        fail("the list announces " + std::to_string(count) + " items, but at most " + std::to_string(in_->most_left()) +
             " bytes are left");
    }
}

/// "1000{0}" takes few bytes for many numbers: the mesh says how many there may be.
void FoamInput::check_repeated(std::uint64_t count) const {
    if (count > std::max(most_repeated_, in_->most_left())) {
        fail("one value is repeated " + std::to_string(count) + " times, more than the mesh has places");
    }
}

void FoamInput::raw_labels(std::uint32_t* out, std::uint64_t count) {
    std::vector<unsigned char> raw(std::min<std::uint64_t>(count, 16384) * label_bytes_);
    for (std::uint64_t done = 0; done < count;) {
        const std::uint64_t part = std::min<std::uint64_t>(16384, count - done);
        in_->read(raw.data(), part * label_bytes_);
        for (std::uint64_t i = 0; i < part; ++i) {
            std::int64_t value = 0;
            if (label_bytes_ == 8) {
                std::uint64_t bits = 0;
                std::memcpy(&bits, raw.data() + 8 * i, 8);
                value = static_cast<std::int64_t>(swapped_ ? __builtin_bswap64(bits) : bits);
            } else {
                std::uint32_t bits = 0;
                std::memcpy(&bits, raw.data() + 4 * i, 4);
                value = static_cast<std::int32_t>(swapped_ ? __builtin_bswap32(bits) : bits);
            }
            if (value < 0 || value >= 0x7fffffffLL) {
                fail("a label that is out of range: " + std::to_string(value));
            }
            out[done + i] = static_cast<std::uint32_t>(value);
        }
        done += part;
    }
}

void FoamInput::raw_reals(double* out, std::uint64_t count) {
    if (scalar_bytes_ == 8 && !swapped_) {
        in_->read(out, count * 8);
        return;
    }
    std::vector<unsigned char> raw(std::min<std::uint64_t>(count, 16384) * scalar_bytes_);
    for (std::uint64_t done = 0; done < count;) {
        const std::uint64_t part = std::min<std::uint64_t>(16384, count - done);
        in_->read(raw.data(), part * scalar_bytes_);
        for (std::uint64_t i = 0; i < part; ++i) {
            if (scalar_bytes_ == 8) {
                std::uint64_t bits = 0;
                std::memcpy(&bits, raw.data() + 8 * i, 8);
                bits = __builtin_bswap64(bits);
                std::memcpy(out + done + i, &bits, 8);
            } else {
                std::uint32_t bits = 0;
                float single = 0;
                std::memcpy(&bits, raw.data() + 4 * i, 4);
                bits = swapped_ ? __builtin_bswap32(bits) : bits;
                std::memcpy(&single, &bits, 4);
                out[done + i] = single;
            }
        }
        done += part;
    }
}

Buffer<std::uint32_t> FoamInput::labels() {
    const std::uint64_t size = count();
    if (size == 0) {
        if (accept('(')) {
            expect(")");
        }
        return {};
    }
    if (accept('{')) {
        check_repeated(size);
        const std::uint32_t value = label();
        expect("}");
        Buffer<std::uint32_t> all(size);
        all.fill(value);
        return all;
    }
    expect("(");
    check_room(size, binary() ? label_bytes_ : 2);
    Buffer<std::uint32_t> all(size);
    if (binary()) {
        raw_labels(all.data(), size);
    } else {
        for (auto& value : all) {
            value = label();
        }
    }
    expect(")");
    return all;
}

Buffer<double> FoamInput::reals(std::size_t components) {
    const std::uint64_t size = count();
    if (size == 0) {
        if (accept('(')) {
            expect(")");
        }
        return {};
    }
    if (accept('{')) {
        const auto one = value(components);
        expect("}");
        check_repeated(size);
        Buffer<double> all(size * components);
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i] = one[i % components];
        }
        return all;
    }
    expect("(");
    check_room(size, binary() ? scalar_bytes_ * components : 2 * components);
    Buffer<double> all(size * components);
    if (binary()) {
        raw_reals(all.data(), size * components);
    } else {
        for (std::uint64_t i = 0; i < size; ++i) {
            if (components > 1) {
                expect("(");
            }
            for (std::size_t k = 0; k < components; ++k) {
                all[i * components + k] = number();
            }
            if (components > 1) {
                expect(")");
            }
        }
    }
    expect(")");
    return all;
}

void FoamInput::faces(Buffer<std::uint32_t>& offsets, Buffer<std::uint32_t>& nodes) {
    if (class_ == "faceCompactList" && binary()) {
        offsets = labels();
        nodes = labels();
        const bool begins = !offsets.empty() && offsets[0] == 0 && offsets[offsets.size() - 1] == nodes.size();
        if (!begins || !std::is_sorted(offsets.begin(), offsets.end())) {
            fail("the corners of the faces do not fit their offsets");
        }
        return;
    }
    const std::uint64_t size = count();
    expect("(");
    check_room(size, 2);
    offsets.grow_to(size + 1);
    for (std::uint64_t face = 0; face < size; ++face) {
        offsets[face] = static_cast<std::uint32_t>(nodes.size());
        const std::uint64_t corners = count();
        expect("(");
        check_room(corners, binary() ? label_bytes_ : 2);
        if (nodes.size() + corners > 0x7fffffffULL) {
            fail("too many corners");
        }
        for (std::uint64_t k = 0; k < corners; ++k) {
            std::uint32_t node = 0;
            if (binary()) {
                raw_labels(&node, 1);
            } else {
                node = label();
            }
            nodes.push(node);
        }
        expect(")");
    }
    offsets[size] = static_cast<std::uint32_t>(nodes.size());
    expect(")");
}

std::vector<double> FoamInput::value(std::size_t components) {
    std::vector<double> numbers(components);
    if (components > 1) {
        expect("(");
    }
    for (auto& number_of : numbers) {
        number_of = number();
    }
    if (components > 1) {
        expect(")");
    }
    return numbers;
}

std::size_t FoamInput::components_of(const std::string& type) {
    const auto has = [&](const char* word) { return core::lower_case(type).find(word) != std::string::npos; };
    return has("symmtensor")        ? 6
           : has("sphericaltensor") ? 1
           : has("tensor")          ? 9
           : has("vector")          ? 3
           : has("scalar")          ? 1
                                    : 0;
}

}  // namespace underbody::postproc
