#include "postproc/importers/ensight/ensight_input.h"

#include <algorithm>
#include <cstring>

#include "core/text.h"

namespace underbody::postproc {

namespace {

constexpr std::size_t width = 80;

std::uint32_t turned(std::uint32_t v) { return __builtin_bswap32(v); }

}  // namespace

EnsightInput::EnsightInput(const std::filesystem::path& path, EnsightCoding coding, bool swapped)
    : in_(path), coding_(coding), swapped_(swapped) {}

EnsightCoding EnsightInput::coding_of(const std::filesystem::path& path) {
    char head[90] = {};
    ByteStream in(path);
    in.ensure(sizeof head);
    const auto got = std::min<std::size_t>(sizeof head, static_cast<std::size_t>(in.end() - in.here()));
    std::memcpy(head, in.here(), got);
    const std::string_view text(head, got);
    return text.starts_with("C Binary")                    ? EnsightCoding::c_binary
           : text.substr(0, 20).find("Fortran Binary") < 5 ? EnsightCoding::fortran_binary
                                                           : EnsightCoding::text;
}

void EnsightInput::fail(const std::string& what) const {
    core::Place place = in_.place();
    if (coding_ == EnsightCoding::text) {
        place.line = line_;
    }
    throw core::InputError("format", what, place);
}

bool EnsightInput::at_end() {
    if (coding_ != EnsightCoding::text) {
        return in_.at_end();
    }
    for (;;) {
        const int c = in_.peek();
        if (c < 0) {
            return true;
        }
        if (c > ' ') {
            return false;
        }
        line_ += c == '\n' ? 1 : 0;
        in_.get();
    }
}

/// In Fortran files each record stands between its length, twice.
void EnsightInput::read_record(void* out, std::uint64_t bytes) {
    if (coding_ == EnsightCoding::fortran_binary) {
        std::uint32_t before = 0;
        std::uint32_t after = 0;
        in_.read(&before, 4);
        if (before != bytes && turned(before) != bytes) {
            fail("a record of " + std::to_string(before) + " bytes where " + std::to_string(bytes) + " are expected");
        }
        in_.read(out, bytes);
        in_.read(&after, 4);
        if (after != before) {
            fail("a record that does not end as it began");
        }
        return;
    }
    in_.read(out, bytes);
}

std::string EnsightInput::line() {
    if (coding_ == EnsightCoding::text) {
        if (at_end()) {
            fail("the file ends too early");
        }
        return rest_of_line();
    }
    char raw[width];
    read_record(raw, width);
    const std::string text(raw, width);
    return std::string(core::trimmed(std::string_view(text).substr(0, text.find('\0'))));
}

std::string EnsightInput::rest_of_line() {
    constexpr std::size_t longest = 65536;
    std::string text;
    for (int c = in_.get(); c >= 0 && c != '\n'; c = in_.get()) {
        text += static_cast<char>(c);
        if (text.size() > longest) {
            fail("a line that is too long");
        }
    }
    ++line_;
    return std::string(core::trimmed(text));
}

bool EnsightInput::line_begins_with(std::string_view word) {
    const std::size_t before = coding_ == EnsightCoding::fortran_binary ? 4 : 0;  // the record's length
    return !at_end() && in_.ensure(before + word.size()) && std::string_view(in_.here() + before, word.size()) == word;
}

std::string EnsightInput::line_as_it_is() {
    if (coding_ != EnsightCoding::text) {
        return line();
    }
    // A number may have left the end of its line behind.
    std::string text = rest_of_line();
    return text.empty() ? rest_of_line() : text;
}

void EnsightInput::to_step(int step) {
    constexpr std::string_view mark = "BEGIN TIME STEP";
    for (int found = 0; found <= step;) {
        in_.ensure(width + 8);
        const auto left = static_cast<std::size_t>(in_.end() - in_.here());
        const void* place = left < mark.size() ? nullptr : ::memmem(in_.here(), left, mark.data(), mark.size());
        if (place == nullptr) {
            if (left < width + 8) {
                fail("the file has " + std::to_string(found) + " steps, step " + std::to_string(step + 1) +
                     " is wanted");
            }
            in_.move_to(in_.end() - (mark.size() - 1));
            continue;
        }
        in_.move_to(static_cast<const char*>(place));
        if (coding_ == EnsightCoding::text) {
            for (int c = in_.get(); c >= 0 && c != '\n';) {
                c = in_.get();
            }
        } else {
            in_.skip(width + (coding_ == EnsightCoding::fortran_binary ? 4 : 0));
        }
        ++found;
    }
}

std::string EnsightInput::token() {
    if (at_end()) {
        fail("the file ends too early");
    }
    std::string text;
    for (int c = in_.peek(); c > ' '; c = in_.peek()) {
        text += static_cast<char>(c);
        in_.get();
        if (text.size() > 64) {
            fail("a number that is too long");
        }
    }
    return text;
}

std::int64_t EnsightInput::integer() {
    if (coding_ == EnsightCoding::text) {
        const std::string text = token();
        const auto value = core::parse_integer(text);
        if (!value) {
            fail("expected a whole number, found '" + text + "'");
        }
        return *value;
    }
    std::uint32_t bits = 0;
    read_record(&bits, 4);
    return static_cast<std::int32_t>(swapped_ ? turned(bits) : bits);
}

void EnsightInput::check_room(std::uint64_t count, const std::string& what) {
    const std::uint64_t least = coding_ == EnsightCoding::text ? 2 : 4;
    if (count > in_.most_left() / least + 1) {
        fail(std::to_string(count) + " " + what + " do not fit into the " + std::to_string(in_.most_left()) +
             " bytes that are left");
    }
}

std::uint64_t EnsightInput::count(const std::string& what) {
    const std::int64_t value = integer();
    if (value < 0) {
        fail("a negative number of " + what + ": " + std::to_string(value));
    }
    check_room(static_cast<std::uint64_t>(value), what);
    return static_cast<std::uint64_t>(value);
}

std::int64_t EnsightInput::part_number(bool first) {
    std::int64_t number = integer();
    if (coding_ != EnsightCoding::text && first) {
        const auto other = static_cast<std::int32_t>(turned(static_cast<std::uint32_t>(number)));
        if ((number < 1 || number > 0xffffff) && other >= 1 && other <= 0xffffff) {
            swapped_ = !swapped_;
            number = other;
        }
    }
    if (number < 1) {
        throw core::InputError(
            "format", "a part has the number " + std::to_string(number) + ": EnSight counts parts from 1", in_.place(),
            number == 0 ? "the program that wrote it counts from 0: export it again with part numbers from 1"
                        : "the file is damaged or of another coding");
    }
    return number;
}

Buffer<std::uint32_t> EnsightInput::words(std::uint64_t count) {
    Buffer<std::uint32_t> all(count);
    if (count == 0 && coding_ == EnsightCoding::c_binary) {
        return all;
    }
    read_record(all.data(), count * 4);
    for (std::size_t i = 0; swapped_ && i < count; ++i) {
        all[i] = turned(all[i]);
    }
    return all;
}

void EnsightInput::integers(std::vector<std::int64_t>& out, std::uint64_t count) {
    check_room(count, "numbers");
    out.resize(count);
    if (coding_ == EnsightCoding::text) {
        for (auto& value : out) {
            value = integer();
        }
        return;
    }
    const Buffer<std::uint32_t> raw = words(count);
    for (std::size_t i = 0; i < count; ++i) {
        out[i] = static_cast<std::int32_t>(raw[i]);
    }
}

void EnsightInput::reals(double* out, std::uint64_t count) {
    check_room(count, "numbers");
    if (coding_ == EnsightCoding::text) {
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::string text = token();
            const auto value = core::parse_number(text);
            if (!value) {
                fail("expected a number, found '" + text + "'");
            }
            out[i] = *value;
        }
        return;
    }
    const Buffer<std::uint32_t> raw = words(count);
    for (std::size_t i = 0; i < count; ++i) {
        float value = 0;
        std::memcpy(&value, &raw[i], 4);
        out[i] = value;
    }
}

std::vector<std::string> ensight_words(std::string_view text) {
    std::vector<std::string> words;
    std::string word;
    bool quoted = false;
    bool any = false;
    for (const char c : text) {
        if (c == '"') {
            quoted = !quoted;
            any = true;
        } else if (!quoted && static_cast<unsigned char>(c) <= ' ') {
            if (any) {
                words.push_back(word);
            }
            word.clear();
            any = false;
        } else {
            word += c;
            any = true;
        }
    }
    if (any) {
        words.push_back(word);
    }
    return words;
}

}  // namespace underbody::postproc
