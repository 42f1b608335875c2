#include "core/ply_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace underbody::core {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> type_of(std::string_view word) {
    static constexpr std::array<std::pair<std::string_view, Type>, 16> words{{{"char", Type::int8},
                                                                              {"int8", Type::int8},
                                                                              {"uchar", Type::uint8},
                                                                              {"uint8", Type::uint8},
                                                                              {"short", Type::int16},
                                                                              {"int16", Type::int16},
                                                                              {"ushort", Type::uint16},
                                                                              {"uint16", Type::uint16},
                                                                              {"int", Type::int32},
                                                                              {"int32", Type::int32},
                                                                              {"uint", Type::uint32},
                                                                              {"uint32", Type::uint32},
                                                                              {"float", Type::float32},
                                                                              {"float32", Type::float32},
                                                                              {"double", Type::float64},
                                                                              {"float64", Type::float64}}};
    const auto* const found =
        std::find_if(words.begin(), words.end(), [&](const auto& known) { return known.first == word; });
    return found != words.end() ? std::optional(found->second) : std::nullopt;
}

std::size_t size_of(Type type) {
    switch (type) {
        case Type::int8:
        case Type::uint8:
            return 1;
        case Type::int16:
        case Type::uint16:
            return 2;
        case Type::int32:
        case Type::uint32:
        case Type::float32:
            return 4;
        case Type::float64:
            return 8;
    }
    return 8;
}

struct Layout {
    Type type = Type::float32;
    std::optional<Type> length;  ///< of a list
};

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t at = 0;;) {
        at = line.find_first_not_of(" \t\r\v\f", at);
        if (at == std::string_view::npos) {
            return words;
        }
        const std::size_t end = std::min(line.find_first_of(" \t\r\v\f", at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
}

class Reader {
public:
    Reader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    PlyFile read() {
        read_header();
        for (std::size_t e = 0; e < ply_.elements.size(); ++e) {
            prepare(ply_.elements[e], layouts_[e]);
            for (std::size_t i = 0; i < ply_.elements[e].count; ++i) {
                if (format_ == "ascii") {
                    read_line(ply_.elements[e], layouts_[e], i);
                } else {
                    read_record(ply_.elements[e], layouts_[e], i);
                }
            }
        }
        return std::move(ply_);
    }

private:
    [[nodiscard]] Place here() const {
        if (in_text_) {
            return {file_, static_cast<std::int64_t>(line_), {}, {}};
        }
        return {file_, {}, {}, static_cast<std::int64_t>(at_)};
    }
    [[noreturn]] void wrong(const std::string& what, const std::string& hint = "") const {
        throw InputError("parse", what, here(), hint);
    }
    [[noreturn]] void cut_short(const PlyElement& element, std::size_t item) const {
        throw InputError("truncated", "the file ends within " + element.item(item),
                         {file_, {}, {}, static_cast<std::int64_t>(bytes_.size())},
                         "the file was cut short: write it again");
    }

    std::optional<std::string_view> next_line() {
        if (at_ >= bytes_.size()) {
            return std::nullopt;
        }
        const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
        const std::string_view line = bytes_.substr(at_, end - at_);
        at_ = std::min(end + 1, bytes_.size());
        ++line_;
        return line;
    }

    void read_header() {
        in_text_ = true;
        const auto first = next_line();
        if (!first || trimmed(*first) != "ply") {
            throw InputError("format", "a PLY file begins with a line 'ply'", here());
        }
        for (;;) {
            const auto line = next_line();
            if (!line) {
                wrong("the file ends within its header: there is no 'end_header'",
                      "the file was cut short: write it again");
            }
            const auto words = words_of(*line);
            if (words.empty() || words[0] == "obj_info") {
                continue;
            }
            if (words[0] == "end_header") {
                break;
            }
            if (words[0] == "comment") {
                ply_.comments.emplace_back(trimmed(trimmed(*line).substr(words[0].size())));
            } else {
                read_statement(words);
            }
        }
        if (format_.empty()) {
            wrong("the header does not say its format", "'format ascii 1.0' or 'format binary_little_endian 1.0'");
        }
        in_text_ = format_ == "ascii";
        swapped_ = (format_ == "binary_big_endian") != (std::endian::native == std::endian::big);
    }

    void read_statement(const std::vector<std::string_view>& words) {
        const std::string first(words[0]);
        if (first == "format" && words.size() > 1) {
            format_ = words[1];
            if (format_ != "ascii" && format_ != "binary_little_endian" && format_ != "binary_big_endian") {
                throw InputError("format", "PLY of the format '" + format_ + "'", here(),
                                 "ascii, binary_little_endian and binary_big_endian are read");
            }
        } else if (first == "element" && words.size() > 2) {
            const auto count = parse_integer(words[2]);
            if (!count || *count < 0) {
                wrong("'" + std::string(words[2]) + "' is no number of '" + std::string(words[1]) + "'");
            }
            ply_.elements.push_back({std::string(words[1]), static_cast<std::size_t>(*count), {}});
            layouts_.emplace_back();
        } else if (first == "property" && words.size() > 2 && !layouts_.empty()) {
            read_property(words);
        } else {
            wrong("a header line '" + first + "' that makes no sense here",
                  "format, element, property, comment, end_header");
        }
    }

    void read_property(const std::vector<std::string_view>& words) {
        const bool list = words[1] == "list";
        if (list && words.size() < 5) {
            wrong("a list without its types and its name", "'property list uchar int vertex_indices'");
        }
        const auto known = [&](std::string_view word) {
            const auto type = type_of(word);
            if (!type) {
                wrong("'" + std::string(word) + "' is no type of a property",
                      "char, uchar, short, ushort, int, uint, float, double");
            }
            return *type;
        };
        Layout layout{known(list ? words[3] : words[1]), list ? std::optional(known(words[2])) : std::nullopt};
        if (list && (layout.length == Type::float32 || layout.length == Type::float64)) {
            wrong("the length of a list is a whole number, not '" + std::string(words[2]) + "'");
        }
        auto& element = ply_.elements.back();
        const std::string name(words[list ? 4 : 2]);
        if (element.find(name) != nullptr) {
            wrong("'" + element.name + "' has two properties '" + name + "'");
        }
        element.properties.push_back({name, list, {}, {}});
        layouts_.back().push_back(layout);
    }

    /// Makes room, once it is sure that the file can hold as many.
    void prepare(PlyElement& element, const std::vector<Layout>& layouts) {
        std::size_t least = 0;  // bytes of an item
        for (const auto& layout : layouts) {
            // In text a value has a digit and a separator; the last one of the file may lack the separator.
            least += in_text_ ? 2 : size_of(layout.length.value_or(layout.type));
        }
        const std::size_t left = bytes_.size() - at_ + (in_text_ ? 1 : 0);
        if (layouts.empty() ? element.count > left : element.count > left / least) {
            throw InputError("truncated",
                             "the header states " + std::to_string(element.count) + " of '" + element.name +
                                 "', for which " + std::to_string(bytes_.size() - at_) + " bytes are too few",
                             {file_, {}, {}, static_cast<std::int64_t>(bytes_.size())},
                             "the file was cut short: write it again");
        }
        for (auto& property : element.properties) {
            property.values.reserve(element.count);
            if (property.list) {
                property.list_begin.reserve(element.count + 1);
                property.list_begin.push_back(0);
            }
        }
    }

    void read_line(PlyElement& element, const std::vector<Layout>& layouts, std::size_t item) {
        std::vector<std::string_view> words;
        while (words.empty()) {
            const auto line = next_line();
            if (!line) {
                cut_short(element, item);
            }
            words = words_of(*line);
        }
        std::size_t next = 0;
        const auto number = [&] {
            if (next >= words.size()) {
                if (at_ >= bytes_.size()) {
                    cut_short(element, item);
                }
                wrong(element.item(item) + " has only " + std::to_string(words.size()) + " values");
            }
            const auto value = parse_number(words[next]);
            if (!value) {
                wrong("'" + std::string(words[next]) + "' is no number");
            }
            ++next;
            return *value;
        };
        for (std::size_t p = 0; p < layouts.size(); ++p) {
            auto& property = element.properties[p];
            std::size_t values = 1;
            if (property.list) {
                const double length = number();
                if (!(length >= 0) || length != std::floor(length)) {
                    wrong("a list of " + format_number(length) + " values");
                }
                values =
                    length > static_cast<double>(words.size()) ? words.size() + 1 : static_cast<std::size_t>(length);
            }
            for (std::size_t k = 0; k < values; ++k) {
                property.values.push_back(number());
            }
            close(property);
        }
        if (next < words.size()) {
            wrong(element.item(item) + " has " + std::to_string(words.size()) + " values where its properties take " +
                  std::to_string(next));
        }
    }

    void read_record(PlyElement& element, const std::vector<Layout>& layouts, std::size_t item) {
        for (std::size_t p = 0; p < layouts.size(); ++p) {
            auto& property = element.properties[p];
            std::size_t values = 1;
            if (layouts[p].length) {
                if (size_of(*layouts[p].length) > bytes_.size() - at_) {
                    cut_short(element, item);
                }
                const double length = take(*layouts[p].length);
                if (length < 0) {
                    wrong("a list of " + format_number(length) + " values in " + element.item(item));
                }
                values = static_cast<std::size_t>(length);
            }
            if (values > (bytes_.size() - at_) / size_of(layouts[p].type)) {
                cut_short(element, item);
            }
            for (std::size_t k = 0; k < values; ++k) {
                property.values.push_back(take(layouts[p].type));
            }
            close(property);
        }
    }

    static void close(PlyProperty& property) {
        if (property.list) {
            property.list_begin.push_back(property.values.size());
        }
    }

    double take(Type type) {
        switch (type) {
            case Type::int8:
                return take_as<std::int8_t>();
            case Type::uint8:
                return take_as<std::uint8_t>();
            case Type::int16:
                return take_as<std::int16_t>();
            case Type::uint16:
                return take_as<std::uint16_t>();
            case Type::int32:
                return take_as<std::int32_t>();
            case Type::uint32:
                return take_as<std::uint32_t>();
            case Type::float32:
                return take_as<float>();
            case Type::float64:
                return take_as<double>();
        }
        return 0;
    }

    /// The caller has made sure that the bytes are there.
    template <class T>
    double take_as() {
        std::array<char, sizeof(T)> raw{};
        std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        if (swapped_) {
            std::reverse(raw.begin(), raw.end());
        }
        return static_cast<double>(std::bit_cast<T>(raw));
    }

    std::string_view bytes_;
    const std::string& file_;
    std::size_t at_ = 0;
    std::size_t line_ = 0;
    bool in_text_ = true;
    bool swapped_ = false;
    std::string format_;
    PlyFile ply_;
    std::vector<std::vector<Layout>> layouts_;  ///< beside ply_.elements and their properties
};

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
    const auto found =
        std::find_if(properties.begin(), properties.end(), [&](const auto& p) { return p.name == property; });
    return found != properties.end() ? &*found : nullptr;
}

std::string PlyElement::item(std::size_t item) const {
    return "'" + name + "' " + std::to_string(item + 1) + " of " + std::to_string(count);
}

const PlyElement* PlyFile::find(std::string_view element) const {
    const auto found = std::find_if(elements.begin(), elements.end(), [&](const auto& e) { return e.name == element; });
    return found != elements.end() ? &*found : nullptr;
}

PlyFile read_ply(std::string_view bytes, const std::string& file) { return Reader(bytes, file).read(); }

PlyPoints ply_points(const PlyFile& ply, const std::string& file) {
    const PlyElement* vertices = ply.find("vertex");
    std::array<const PlyProperty*, 3> axes{};
    for (std::size_t k = 0; k < 3; ++k) {
        axes[k] = vertices != nullptr ? vertices->find(std::array{"x", "y", "z"}[k]) : nullptr;
        if (axes[k] == nullptr || axes[k]->list) {
            throw InputError(
                "format", vertices == nullptr ? "the PLY has no element 'vertex'" : "its vertices have no x, y and z",
                {file, {}, {}, {}});
        }
        for (std::size_t i = 0; i < vertices->count; ++i) {
            if (!std::isfinite(axes[k]->values[i])) {
                throw InputError("number", vertices->item(i) + " has a coordinate that is not a finite number",
                                 {file, {}, {}, {}}, "a mesh of finite coordinates");
            }
        }
    }
    return {axes[0]->values, axes[1]->values, axes[2]->values};
}

const PlyProperty* ply_corners(const PlyFile& ply, const std::string& file) {
    const PlyElement* faces = ply.find("face");
    if (faces == nullptr || faces->count == 0) {
        return nullptr;
    }
    const PlyProperty* corners = faces->find("vertex_indices");
    corners = corners != nullptr ? corners : faces->find("vertex_index");
    if (corners == nullptr || !corners->list) {
        throw InputError("format", "its faces have no list 'vertex_indices'", {file, {}, {}, {}});
    }
    const PlyElement* vertices = ply.find("vertex");
    const double points = vertices != nullptr ? static_cast<double>(vertices->count) : 0;
    for (std::size_t i = 0; i < faces->count; ++i) {
        const std::size_t end = corners->list_begin[i + 1];
        if (end < corners->list_begin[i] + 3) {
            throw InputError("index",
                             faces->item(i) + " has " + std::to_string(end - corners->list_begin[i]) + " corners",
                             {file, {}, {}, {}}, "three are the fewest");
        }
        for (std::size_t k = corners->list_begin[i]; k < end; ++k) {
            const double vertex = corners->values[k];
            if (!(vertex >= 0) || !(vertex < points) || vertex != std::floor(vertex)) {
                throw InputError("index",
                                 faces->item(i) + " names vertex " + format_number(vertex) + ", and there are " +
                                     format_number(points) + ", counted from 0",
                                 {file, {}, {}, {}});
            }
        }
    }
    return corners;
}

}  // namespace underbody::core
