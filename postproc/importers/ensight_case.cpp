#include "postproc/importers/ensight_case.h"

#include <algorithm>
#include <map>

#include "core/file.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

constexpr std::size_t most_text = std::size_t{16} << 20;

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    std::string word;
    bool quoted = false;
    bool any = false;
    for (const char c : text) {
        if (c == '"') {
            quoted = !quoted;
            any = true;
        } else if (!quoted && (c == ' ' || c == '\t')) {
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

struct TimeSet {
    int steps = 1;
    int start = 0;
    int increment = 1;
    std::vector<int> numbers;
    std::vector<std::string> values;
};

class CaseReader {
public:
    explicit CaseReader(const std::filesystem::path& path) : path_(path) {}
    EnsightCase read();

private:
    struct Pending {
        EnsightVariable variable;
        std::string pattern;
        int time_set = 0;
    };

    [[noreturn]] void fail(const std::string& what) const {
        throw core::InputError("format", what, {path_.string(), line_, {}, {}});
    }
    void geometry(const std::string& key, const std::string& rest);
    void variable(const std::string& key, const std::string& rest);
    void time(const std::string& key, const std::string& rest, std::string_view line);
    [[nodiscard]] int whole(const std::string& text) const {
        const auto value = core::parse_integer(text);
        if (!value || *value < -1000000000 || *value > 1000000000) {
            fail("expected a whole number, found '" + text + "'");
        }
        return static_cast<int>(*value);
    }
    [[nodiscard]] std::filesystem::path complete(const std::string& pattern, int time_set) const;

    std::filesystem::path path_;
    std::int64_t line_ = 0;
    EnsightCase result_;
    std::string geometry_pattern_;
    int geometry_set_ = 0;
    std::vector<Pending> pending_;
    std::map<int, TimeSet> sets_;
    TimeSet* set_ = nullptr;
    enum class Listing { none, values, numbers } listing_ = Listing::none;
};

std::filesystem::path CaseReader::complete(const std::string& pattern, int time_set) const {
    std::string name = pattern;
    const std::size_t star = name.find('*');
    if (star != std::string::npos) {
        std::size_t width = 0;
        while (star + width < name.size() && name[star + width] == '*') {
            ++width;
        }
        const auto found = sets_.find(time_set);
        const TimeSet set = found != sets_.end() ? found->second : sets_.empty() ? TimeSet{} : sets_.begin()->second;
        const int last = set.steps - 1;
        const int number = set.numbers.empty() ? set.start + last * set.increment : set.numbers.back();
        std::string digits = std::to_string(number);
        digits.insert(0, width - std::min(width, digits.size()), '0');
        name.replace(star, width, digits);
    }
    return path_.parent_path() / name;
}

void CaseReader::geometry(const std::string& key, const std::string& rest) {
    if (key != "model") {
        return;  // measured, match, boundary, rigid_body: particles and the like
    }
    auto words = words_of(rest);
    int numbers = 0;
    while (words.size() > 1 && core::parse_integer(words.front()) && numbers < 2) {
        if (numbers++ == 0) {
            geometry_set_ = whole(words.front());
        } else {
            fail("file sets (several steps in one file) are not read");
        }
        words.erase(words.begin());
    }
    if (words.empty()) {
        fail("the model has no file name");
    }
    geometry_pattern_ = words.front();
}

void CaseReader::variable(const std::string& key, const std::string& rest) {
    auto words = words_of(rest);
    if (key.starts_with("constant per case") || key.starts_with("constant per part")) {
        if (words.size() >= 2) {
            result_.constants.emplace_back(words[words.size() - 2], words.back());
        }
        return;
    }
    Pending entry;
    entry.variable.on_nodes = key.ends_with("per node") || key.ends_with("per measured node");
    const bool on_elements = key.ends_with("per element");
    entry.variable.components = key.starts_with("scalar")        ? 1
                                : key.starts_with("vector")      ? 3
                                : key.starts_with("tensor symm") ? 6
                                : key.starts_with("tensor asym") ? 9
                                                                 : 0;
    if (entry.variable.components == 0 || (!entry.variable.on_nodes && !on_elements) ||
        key.find("measured") != std::string::npos) {
        result_.problems.push_back(
            {core::Problem::Severity::note, "'" + key + "' is not read", {path_.string(), line_, {}, {}}});
        return;
    }
    for (int numbers = 0; words.size() > 2 && core::parse_integer(words.front()) && numbers < 2; ++numbers) {
        if (numbers == 0) {
            entry.time_set = whole(words.front());
        } else {
            fail("file sets (several steps in one file) are not read");
        }
        words.erase(words.begin());
    }
    if (words.size() < 2) {
        fail("a variable without name or file");
    }
    entry.pattern = words.back();
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        entry.variable.name += (i > 0 ? " " : "") + words[i];
    }
    pending_.push_back(std::move(entry));
}

void CaseReader::time(const std::string& key, const std::string& rest, std::string_view line) {
    const auto words = words_of(rest);
    const auto first = [&]() -> std::string { return words.empty() ? std::string() : words.front(); };
    if (key == "time set") {
        set_ = &sets_[whole(first())];
        listing_ = Listing::none;
        return;
    }
    if (set_ == nullptr) {
        set_ = &sets_[1];
    }
    if (key == "number of steps") {
        set_->steps = std::max(1, whole(first()));
    } else if (key == "filename start number") {
        set_->start = whole(first());
    } else if (key == "filename increment") {
        set_->increment = whole(first());
    } else if (key == "filename numbers") {
        listing_ = Listing::numbers;
        for (const auto& word : words) {
            set_->numbers.push_back(whole(word));
        }
    } else if (key == "time values") {
        listing_ = Listing::values;
        set_->values.insert(set_->values.end(), words.begin(), words.end());
    } else if (key.empty() && listing_ != Listing::none) {
        for (const auto& word : words_of(line)) {
            if (listing_ == Listing::numbers) {
                set_->numbers.push_back(whole(word));
            } else {
                set_->values.push_back(word);
            }
        }
    }
}

EnsightCase CaseReader::read() {
    const core::MappedFile file(path_);
    if (file.bytes().size() > most_text) {
        fail("a case file of more than 16 MB");
    }
    std::string section;
    bool gold = false;
    for (const auto raw : core::split(file.bytes(), '\n')) {
        ++line_;
        const std::string_view line = core::trimmed(raw);
        if (line.empty() || line.front() == '#') {
            continue;
        }
        for (const char* name :
             {"FORMAT", "GEOMETRY", "VARIABLE", "TIME", "FILE", "MATERIAL", "BLOCK_CONTINUATION", "SCRIPTS"}) {
            if (line == name) {
                section = name;
            }
        }
        if (line == section) {
            continue;
        }
        const std::size_t colon = line.find(':');
        const bool keyed = colon != std::string_view::npos;
        const std::string key = keyed ? core::lower_case(core::trimmed(line.substr(0, colon))) : std::string();
        const std::string rest(keyed ? core::trimmed(line.substr(colon + 1)) : std::string_view());
        if (section == "FORMAT" && key == "type") {
            gold = core::lower_case(rest).find("gold") != std::string::npos;
            if (!gold) {
                fail("only EnSight Gold is read, this is '" + rest + "'");
            }
        } else if (section == "GEOMETRY") {
            geometry(key, rest);
        } else if (section == "VARIABLE" && keyed) {
            variable(key, rest);
        } else if (section == "TIME") {
            time(key, rest, line);
        }
    }
    line_ = 0;
    if (!gold || geometry_pattern_.empty()) {
        throw core::InputError("format", "the case names no geometry in EnSight Gold format",
                               {path_.string(), {}, {}, {}});
    }
    result_.geometry = complete(geometry_pattern_, geometry_set_);
    for (auto& entry : pending_) {
        entry.variable.file = complete(entry.pattern, entry.time_set);
        result_.variables.push_back(std::move(entry.variable));
    }
    if (!sets_.empty()) {
        result_.steps = sets_.begin()->second.steps;
        result_.time = sets_.begin()->second.values.empty() ? "" : sets_.begin()->second.values.back();
    }
    return std::move(result_);
}

}  // namespace

bool is_ensight_case(std::string_view head) {
    const std::size_t format = head.find("FORMAT");
    if (format == std::string_view::npos || format > 4096) {
        return false;
    }
    // Only comments may stand before it.
    for (const auto raw : core::split(head.substr(0, format), '\n')) {
        const auto line = core::trimmed(raw);
        if (!line.empty() && line.front() != '#') {
            return false;
        }
    }
    const std::string rest = core::lower_case(head.substr(format, 400));
    return rest.find("type:") != std::string::npos && rest.find("ensight") != std::string::npos;
}

EnsightCase read_ensight_case(const std::filesystem::path& path) { return CaseReader(path).read(); }

}  // namespace underbody::postproc
