#include "postproc/importers/ply.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

struct Property {
    std::size_t bytes = 0;
    std::size_t count_bytes = 0;  ///< of a list's length; 0: no list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

std::size_t bytes_of(std::string_view type) {
    if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") {
        return 1;
    }
    if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") {
        return 2;
    }
    if (type == "int" || type == "uint" || type == "float" || type == "int32" || type == "uint32" || type == "float32") {
        return 4;
    }
    return type == "double" || type == "float64" ? 8 : 0;
}

class Checker {
public:
    explicit Checker(const std::filesystem::path& path) : file_(path), text_(file_.bytes()) {}

    void check() {
        read_header();
        for (const auto& element : elements_) {
            for (std::uint64_t i = 0; i < element.count; ++i) {
                if (ascii_) {
                    line(element, i);
                } else {
                    record(element, i);
                }
            }
        }
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw core::InputError("format", what, {file_.name(), {}, {}, static_cast<std::int64_t>(at_)},
                               "the file is cut short or damaged");
    }

    std::string_view next_line() {
        const std::size_t end = text_.find('\n', at_);
        const std::string_view found = text_.substr(at_, end == std::string_view::npos ? end : end - at_);
        at_ = end == std::string_view::npos ? text_.size() : end + 1;
        return core::trimmed(found);
    }

    void read_header() {
        for (;;) {
            if (at_ >= text_.size()) {
                fail("the file ends within its header");
            }
            std::vector<std::string_view> words;
            for (const auto word : core::split(next_line(), ' ')) {
                if (!word.empty()) {
                    words.push_back(word);
                }
            }
            if (words.empty()) {
                continue;
            }
            if (words[0] == "end_header") {
                return;
            }
            if (words[0] == "format" && words.size() > 1) {
                ascii_ = words[1] == "ascii";
                swapped_ = words[1] == "binary_big_endian";
            } else if (words[0] == "element" && words.size() > 2) {
                const auto count = core::parse_integer(words[2]);
                if (!count || *count < 0 || static_cast<std::uint64_t>(*count) > text_.size()) {
                    fail("the header announces " + std::string(words[2]) + " of '" + std::string(words[1]) + "' in " +
                         std::to_string(text_.size()) + " bytes");
                }
                elements_.push_back({std::string(words[1]), static_cast<std::uint64_t>(*count), {}});
            } else if (words[0] == "property" && words.size() > 2 && !elements_.empty()) {
                const bool list = words[1] == "list" && words.size() > 4;
                const Property property{bytes_of(list ? words[3] : words[1]), list ? bytes_of(words[2]) : 0};
                if (property.bytes == 0 || (list && property.count_bytes == 0)) {
                    fail("a property of unknown type");
                }
                elements_.back().properties.push_back(property);
            }
        }
    }

    void line(const Element& element, std::uint64_t index) {
        std::size_t found = 0;
        std::size_t wanted = 0;
        std::vector<std::string_view> words;
        while (words.empty()) {
            if (at_ >= text_.size()) {
                ends(element, index);
            }
            for (const auto word : core::split(next_line(), ' ')) {
                if (!word.empty()) {
                    words.push_back(word);
                }
            }
        }
        for (const auto& property : element.properties) {
            const auto length = property.count_bytes > 0 && found < words.size() ? core::parse_integer(words[found]) : std::nullopt;
            const std::size_t items = property.count_bytes == 0 ? 1 : 1 + static_cast<std::size_t>(std::max(0LL, length.value_or(0)));
            wanted += items;
            found += items;
        }
        if (words.size() < wanted) {
            ends(element, index);
        }
    }

    void record(const Element& element, std::uint64_t index) {
        for (const auto& property : element.properties) {
            std::uint64_t items = 1;
            if (property.count_bytes > 0) {
                items = 0;
                if (property.count_bytes > text_.size() - at_) {
                    ends(element, index);
                }
                for (std::size_t k = 0; k < property.count_bytes; ++k) {
                    const std::size_t from = swapped_ ? k : property.count_bytes - 1 - k;
                    items = items << 8 | static_cast<unsigned char>(text_[at_ + from]);
                }
                at_ += property.count_bytes;
            }
            if (items > (text_.size() - at_) / property.bytes) {
                ends(element, index);
            }
            at_ += items * property.bytes;
        }
    }

    [[noreturn]] void ends(const Element& element, std::uint64_t index) const {
        fail("the file ends at '" + element.name + "' " + std::to_string(index + 1) + " of " + std::to_string(element.count));
    }

    core::MappedFile file_;
    std::string_view text_;
    std::size_t at_ = 0;
    std::vector<Element> elements_;
    bool ascii_ = true;
    bool swapped_ = false;
};

}  // namespace

void check_ply(const std::filesystem::path& path) { Checker(path).check(); }

}  // namespace underbody::postproc
