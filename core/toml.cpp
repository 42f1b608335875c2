#include "core/toml.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/file.h"
#include "core/file_format.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::core {

namespace fs = std::filesystem;

struct TomlTable::Shared {
    toml::table root;
    std::string source;
    fs::path folder;
    const FileFormat* format = nullptr;
    /// For each table: the keys somebody asked for, present or not.
    std::map<const void*, std::set<std::string, std::less<>>> asked;
};

namespace {

const toml::table& as_table(const void* node) { return *static_cast<const toml::table*>(node); }

const toml::table& nothing() {
    static const toml::table empty;
    return empty;
}

Place place_of(const toml::source_region& region, const std::string& source) {
    Place place{source, {}, {}, {}};
    if (region.begin.line > 0) {
        place.line = static_cast<std::int64_t>(region.begin.line);
        place.column = static_cast<std::int64_t>(region.begin.column);
    }
    return place;
}

double number_of(const toml::node& node, std::string_view unit, const std::string& path, const Place& place) {
    try {
        if (const auto text = node.value_exact<std::string>()) {
            return parse_in(*text, unit, place);
        }
    } catch (const InputError& error) {
        throw InputError(error.kind(), path + ": " + error.message(), error.place(), error.hint());
    }
    if (node.is_number()) {
        const double value = *node.value<double>();
        if (!std::isfinite(value)) {
            throw InputError("range", path + " is not finite", place);
        }
        return value;
    }
    throw InputError("type", path + " is neither a number nor a text with a unit", place,
                     "write " + path + " = \"1 " + std::string(unit) + "\"");
}

std::string key_path(const std::string& path, std::string_view key) {
    return key.empty() ? path : path.empty() ? std::string(key) : path + "." + std::string(key);
}

/// A key that the program asks for must be described, and as `kind` (a unit, a word that it may be; empty: any).
void expect_described(const FileFormat* format, const std::string& path, std::string_view key, std::string_view kind) {
    if (format == nullptr) {
        return;
    }
    const FileKey* entry = format->key(path, key);
    const bool fits = entry != nullptr && (entry->name == "*" || entry->kind.find(kind) != std::string::npos ||
                                           entry->kind.find("unit") != std::string::npos);
    if (kind.empty() ? !format->knows(path, key) : !fits) {
        throw std::logic_error("the format '" + format->name + "' does not describe " + key_path(path, key) +
                               (kind.empty() ? "" : " as " + std::string(kind)));
    }
}

/// What to do about a missing key: the format's example, else `otherwise`.
std::string how_to_add(const FileFormat* format, const std::string& path, std::string_view key,
                       std::string_view otherwise) {
    const FileKey* entry = format != nullptr ? format->key(path, key) : nullptr;
    const bool described = entry != nullptr && entry->name != "*";
    if (!described && otherwise.empty()) {
        return {};
    }
    const std::string heading = heading_of(path);
    return "add " + std::string(key) + " = " + (described ? entry->example : std::string(otherwise)) +
           (heading.empty() ? "" : " under " + heading) + (described ? " (" + entry->meaning + ")" : "");
}

}  // namespace

TomlTable::TomlTable(std::shared_ptr<Shared> shared, const void* node, std::string path)
    : shared_(std::move(shared)), node_(node), path_(std::move(path)) {}

const void* TomlTable::value(std::string_view key) const {
    expect_described(shared_->format, path_, key, {});
    shared_->asked[node_].emplace(key);
    return as_table(node_).get(key);
}

std::string TomlTable::path_of(std::string_view key) const { return key_path(path_, key); }

Place TomlTable::place(std::string_view key) const {
    const toml::table& table = as_table(node_);
    if (const auto found = table.find(key); found != table.end()) {
        Place place = place_of(found->first.source(), shared_->source);
        return place.line ? place : place_of(found->second.source(), shared_->source);
    }
    return place_of(table.source(), shared_->source);
}

bool TomlTable::has(std::string_view key) const { return value(key) != nullptr; }

std::optional<double> TomlTable::find_quantity(std::string_view key, std::string_view unit_si) const {
    expect_described(shared_->format, path_, key, unit_si);
    const auto* node = static_cast<const toml::node*>(value(key));
    if (node == nullptr) {
        return std::nullopt;
    }
    return number_of(*node, unit_si, path_of(key), place(key));
}

double TomlTable::quantity(std::string_view key, std::string_view unit_si) const {
    if (const auto found = find_quantity(key, unit_si)) {
        return *found;
    }
    throw InputError("missing", "'" + path_of(key) + "' is missing", place(),
                     how_to_add(shared_->format, path_, key, "\"1 " + std::string(unit_si) + "\""));
}

double TomlTable::quantity_or(std::string_view key, std::string_view unit_si, double fallback) const {
    return find_quantity(key, unit_si).value_or(fallback);
}

std::vector<double> TomlTable::quantities(std::string_view key, std::string_view unit_si) const {
    expect_described(shared_->format, path_, key, unit_si);
    const auto* node = static_cast<const toml::node*>(value(key));
    if (node == nullptr) {
        throw InputError("missing", "'" + path_of(key) + "' is missing", place(),
                         how_to_add(shared_->format, path_, key, "[\"1 " + std::string(unit_si) + "\"]"));
    }
    std::vector<double> values;
    if (const auto* array = node->as_array()) {
        for (const auto& item : *array) {
            values.push_back(number_of(item, unit_si, path_of(key), place_of(item.source(), shared_->source)));
        }
    } else {
        values.push_back(number_of(*node, unit_si, path_of(key), place(key)));
    }
    return values;
}

std::string TomlTable::string(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    if (node == nullptr) {
        throw InputError("missing", "'" + path_of(key) + "' is missing", place(),
                         how_to_add(shared_->format, path_, key, {}));
    }
    if (const auto text = node->value_exact<std::string>()) {
        return *text;
    }
    throw InputError("type", "'" + path_of(key) + "' is not a text", place(key), "put it in quotes");
}

std::string TomlTable::string_or(std::string_view key, std::string fallback) const {
    return has(key) ? string(key) : std::move(fallback);
}

std::string TomlTable::choice(std::string_view key, const std::vector<std::string>& choices,
                              std::optional<std::string> fallback) const {
    for (const auto& choice : choices) {
        if (!choice.empty()) {
            expect_described(shared_->format, path_, key, choice);
        }
    }
    if (!has(key) && fallback) {
        return *fallback;
    }
    const std::string chosen = string(key);
    for (const auto& choice : choices) {
        if (choice == chosen) {
            return chosen;
        }
    }
    throw InputError("name", path_of(key) + ": '" + chosen + "' is not known", place(key),
                     did_you_mean(chosen, choices));
}

std::vector<std::string> TomlTable::strings(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    std::vector<std::string> values;
    if (node == nullptr) {
        return values;
    }
    if (const auto text = node->value_exact<std::string>()) {
        return {*text};
    }
    const auto* array = node->as_array();
    if (array == nullptr) {
        throw InputError("type", "'" + path_of(key) + "' is not a list of texts", place(key));
    }
    for (const auto& item : *array) {
        const auto text = item.value_exact<std::string>();
        if (!text) {
            throw InputError("type", "'" + path_of(key) + "' holds something that is not a text",
                             place_of(item.source(), shared_->source));
        }
        values.push_back(*text);
    }
    return values;
}

bool TomlTable::boolean_or(std::string_view key, bool fallback) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    if (node == nullptr) {
        return fallback;
    }
    if (const auto flag = node->value_exact<bool>()) {
        return *flag;
    }
    throw InputError("type", "'" + path_of(key) + "' is neither true nor false", place(key));
}

std::int64_t TomlTable::integer_or(std::string_view key, std::int64_t fallback) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    if (node == nullptr) {
        return fallback;
    }
    if (const auto number = node->value_exact<std::int64_t>()) {
        return *number;
    }
    throw InputError("type", "'" + path_of(key) + "' is not a whole number", place(key));
}

TomlTable TomlTable::table(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    if (node == nullptr) {
        throw InputError("missing", "the table [" + path_of(key) + "] is missing", place(),
                         shared_->format != nullptr ? shared_->format->how_to_add_table(path_, path_of(key)) : "");
    }
    if (const auto* table = node->as_table()) {
        return {shared_, table, path_of(key)};
    }
    throw InputError("type", "'" + path_of(key) + "' is not a table", place(key));
}

TomlTable TomlTable::table_or_empty(std::string_view key) const {
    return has(key) ? table(key) : TomlTable{shared_, &nothing(), path_of(key)};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    std::vector<TomlTable> result;
    if (node == nullptr) {
        return result;
    }
    if (const auto* array = node->as_array()) {
        std::size_t index = 0;
        for (const auto& item : *array) {
            const auto* table = item.as_table();
            if (table == nullptr) {
                throw InputError("type", "'" + path_of(key) + "' is not a list of tables", place(key),
                                 "write [[" + path_of(key) + "]] before each one");
            }
            result.emplace_back(shared_, table, path_of(key) + "[" + std::to_string(index++) + "]");
        }
        return result;
    }
    throw InputError("type", "'" + path_of(key) + "' is not a list of tables", place(key),
                     "write [[" + path_of(key) + "]] with two brackets");
}

std::vector<std::string> TomlTable::keys() const {
    std::vector<std::pair<std::pair<std::int64_t, std::int64_t>, std::string>> ordered;
    for (const auto& [key, node] : as_table(node_)) {
        const auto where = key.source().begin;
        ordered.push_back({{where.line, where.column}, std::string(key.str())});
    }
    std::sort(ordered.begin(), ordered.end());
    std::vector<std::string> names;
    for (auto& item : ordered) {
        names.push_back(std::move(item.second));
    }
    return names;
}

bool TomlTable::is_string(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    return node != nullptr && node->is_string();
}
bool TomlTable::is_table(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    return node != nullptr && node->is_table();
}
bool TomlTable::is_array(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    return node != nullptr && node->is_array();
}
bool TomlTable::is_number(std::string_view key) const {
    const auto* node = static_cast<const toml::node*>(value(key));
    return node != nullptr && node->is_number();
}

fs::path TomlTable::file(std::string_view key) const {
    const fs::path path = string(key);
    return path.is_absolute() ? path : shared_->folder / path;
}

fs::path TomlTable::folder() const { return shared_->folder; }

void TomlTable::accept(std::string_view key) const {
    expect_described(shared_->format, path_, key, {});
    shared_->asked[node_].emplace(key);
}

void TomlTable::finish() const {
    const auto asked_here = shared_->asked.find(node_);
    for (const auto& [key, node] : as_table(node_)) {
        const std::string name(key.str());
        if (asked_here == shared_->asked.end() || !asked_here->second.contains(name)) {
            std::vector<std::string> known;
            if (asked_here != shared_->asked.end()) {
                known.assign(asked_here->second.begin(), asked_here->second.end());
            }
            const FileKey* entry = shared_->format != nullptr ? shared_->format->key(path_, name) : nullptr;
            if (entry != nullptr && entry->name != "*") {
                throw InputError(
                    "key", "'" + path_of(name) + "' has no use beside the other keys", place(name),
                    entry->meaning + (entry->instead_of.empty() ? "" : ", in place of '" + entry->instead_of + "'"));
            }
            throw InputError("key", "unknown key '" + path_of(name) + "'", place(name), did_you_mean(name, known));
        }
        if (const auto* below = node.as_table(); below != nullptr && shared_->asked.contains(below)) {
            TomlTable(shared_, below, path_of(name)).finish();
        }
        if (const auto* array = node.as_array()) {
            std::size_t index = 0;
            for (const auto& item : *array) {
                const auto* table = item.as_table();
                if (table != nullptr && shared_->asked.contains(table)) {
                    TomlTable(shared_, table, path_of(name) + "[" + std::to_string(index) + "]").finish();
                }
                ++index;
            }
        }
    }
}

namespace {

/// Throws for the first name, in the file's order, that the format does not know.
void check_names(const TomlTable& table, const toml::table& node, const FileFormat& format) {
    for (const std::string& name : table.keys()) {
        if (!format.knows(table.path_of({}), name)) {
            throw InputError("key", "unknown key '" + table.path_of(name) + "'", table.place(name),
                             did_you_mean(name, format.names(table.path_of({}))));
        }
        const std::string path = table.path_of(name);
        if (node.get(name)->is_table() && (format.takes_any_name(path) || !format.names(path).empty())) {
            check_names(table.table(name), *node.get_as<toml::table>(name), format);
        }
        if (const auto* array = node.get_as<toml::array>(name); array != nullptr && array->is_array_of_tables()) {
            const std::vector<TomlTable> entries = table.tables(name);
            for (std::size_t i = 0; i < entries.size() && format.table(path + "[]") != nullptr; ++i) {
                check_names(entries[i], *array->get_as<toml::table>(i), format);
            }
        }
    }
}

std::shared_ptr<TomlTable::Shared> parsed(std::string_view text, const std::string& source, const fs::path& folder) {
    auto shared = std::make_shared<TomlTable::Shared>();
    shared->source = source;
    shared->folder = folder;
    try {
        shared->root = toml::parse(text, source);
    } catch (const toml::parse_error& error) {
        throw InputError("parse", std::string(error.description()), place_of(error.source(), source),
                         "this is a TOML file: key = value, [table], [[list of tables]]");
    }
    return shared;
}

}  // namespace

TomlTable read_toml(const fs::path& path, const FileFormat& format) {
    const MappedFile file(path);
    return read_toml_text(file.bytes(), path.string(), path.has_parent_path() ? path.parent_path() : fs::path("."),
                          format);
}

TomlTable read_toml_text(std::string_view text, const std::string& source, const fs::path& folder,
                         const FileFormat& format) {
    const std::shared_ptr<TomlTable::Shared> shared = parsed(text, source, folder);
    check_names({shared, &shared->root, {}}, shared->root, format);
    shared->format = &format;
    shared->asked.clear();  // the check has asked for every key; the reader must do so itself
    return {shared, &shared->root, {}};
}

TomlTable read_toml(const fs::path& path) {
    const MappedFile file(path);
    return read_toml_text(file.bytes(), path.string(), path.has_parent_path() ? path.parent_path() : fs::path("."));
}

TomlTable read_toml_text(std::string_view text, const std::string& source, const fs::path& folder) {
    const std::shared_ptr<TomlTable::Shared> shared = parsed(text, source, folder);
    return {shared, &shared->root, {}};
}

std::string toml_string(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        switch (c) {
            case '"':
                result += "\\\"";
                break;
            case '\\':
                result += "\\\\";
                break;
            case '\n':
                result += "\\n";
                break;
            case '\t':
                result += "\\t";
                break;
            case '\r':
                result += "\\r";
                break;
            default:
                result += c;
        }
    }
    return result + "\"";
}

}  // namespace underbody::core
