#include "postproc/importers/ensight/ensight_case.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/file.h"
#include "core/text.h"
#include "postproc/importers/ensight/ensight_input.h"
#include "postproc/importers/mesh/steps.h"

namespace underbody::postproc {

namespace {

constexpr std::size_t most_text = std::size_t{16} << 20;

/// What may stand before a colon, by section; sections without a list hold what is not read.
const std::map<std::string, std::vector<std::string>> known_keys = {
    {"FORMAT", {"type"}},
    {"GEOMETRY", {"model", "measured", "match", "boundary", "rigid_body", "vector_glyphs"}},
    {"VARIABLE",
     {"scalar per node", "vector per node", "tensor symm per node", "tensor asym per node", "scalar per element",
      "vector per element", "tensor symm per element", "tensor asym per element", "scalar per measured node",
      "vector per measured node", "complex scalar per node", "complex vector per node", "complex scalar per element",
      "complex vector per element", "constant per case", "constant per case file", "constant per part"}},
    {"TIME",
     {"time set", "number of steps", "filename start number", "filename increment", "filename numbers",
      "filename numbers file", "time values", "time values file"}},
    {"FILE", {"file set", "filename index", "number of steps"}}};

/// In small letters, with one blank between words: writers differ in both.
std::string key_of(std::string_view text) {
    std::string key;
    for (const auto& word : ensight_words(text)) {
        key += (key.empty() ? "" : " ") + core::lower_case(word);
    }
    return key;
}

struct TimeSet {
    int steps = 1;
    int start = 0;
    int increment = 1;
    std::vector<int> numbers;
    std::vector<double> values;

    /// The step at a time: the last one that is not later.
    [[nodiscard]] int step_at(std::optional<double> time) const {
        int step = 0;
        for (std::size_t i = 0; time && i < values.size() && static_cast<int>(i) < steps; ++i) {
            if (values[i] <= *time + 1e-6 * std::abs(*time)) {
                step = static_cast<int>(i);
            }
        }
        return time && !values.empty() ? step : steps - 1;
    }
};

/// Files that hold several steps each: "filename index", "number of steps".
struct FileSet {
    std::vector<std::pair<int, int>> files;
    int steps = 1;  ///< without an index
};

class CaseReader {
public:
    CaseReader(const std::filesystem::path& path, std::optional<double> time) : path_(path), time_(time) {}
    EnsightCase read();

private:
    /// A file name as the case gives it.
    struct Pattern {
        std::string name;
        int time_set = 0;
        int file_set = 0;
    };
    struct Pending {
        EnsightVariable variable;
        Pattern pattern;
    };

    [[noreturn]] void fail(const std::string& what) const {
        throw core::InputError("format", what, {path_.string(), line_, {}, {}});
    }
    [[nodiscard]] bool is_known(const std::string& section, const std::string& key, std::string_view line);
    void geometry(const std::string& key, const std::string& rest);
    void variable(const std::string& key, const std::string& rest);
    void time(const std::string& key, const std::string& rest, std::string_view line);
    void files(const std::string& key, const std::string& rest);
    void choose_time();
    void complete_names();
    [[nodiscard]] int whole(const std::string& text) const {
        const auto value = core::parse_integer(text);
        if (!value || *value < -1000000000 || *value > 1000000000) {
            fail("expected a whole number, found '" + text + "'");
        }
        return static_cast<int>(*value);
    }
    [[nodiscard]] double real(const std::string& text) const {
        const auto value = core::parse_number(text);
        if (!value || !std::isfinite(*value)) {
            fail("expected a time, found '" + text + "'");
        }
        return *value;
    }
    void take_sets(std::vector<std::string>& words, std::size_t least, Pattern& pattern) const;
    [[nodiscard]] const TimeSet* set_of(const Pattern& pattern) const;
    [[nodiscard]] EnsightFile complete(const Pattern& pattern, std::optional<int> wanted = {}) const;

    std::filesystem::path path_;
    std::optional<double> time_;
    std::int64_t line_ = 0;
    EnsightCase result_;
    Pattern geometry_;
    std::optional<int> coordinates_only_;  ///< the step that has the elements
    std::vector<Pending> pending_;
    std::map<int, TimeSet> sets_;
    std::map<int, FileSet> file_sets_;
    TimeSet* set_ = nullptr;
    FileSet* file_set_ = nullptr;
    enum class Listing { none, values, numbers } listing_ = Listing::none;
};

const TimeSet* CaseReader::set_of(const Pattern& pattern) const {
    const auto found = sets_.find(pattern.time_set);
    return found != sets_.end() ? &found->second : sets_.empty() ? nullptr : &sets_.begin()->second;
}

EnsightFile CaseReader::complete(const Pattern& pattern, std::optional<int> wanted) const {
    EnsightFile result;
    const TimeSet steady;
    const TimeSet* found = set_of(pattern);
    const TimeSet& set = found != nullptr ? *found : steady;
    const int step = wanted ? *wanted : set.step_at(time_);
    int number = static_cast<std::size_t>(step) < set.numbers.size() ? set.numbers[static_cast<std::size_t>(step)]
                                                                     : set.start + step * set.increment;
    if (const auto several = file_sets_.find(pattern.file_set); pattern.file_set != 0 && several != file_sets_.end()) {
        result.step = step;
        for (const auto& [index, steps] : several->second.files) {
            number = index;
            if (result.step < steps) {
                break;
            }
            result.step -= steps;
        }
    }
    std::string name = pattern.name;
    const std::size_t star = name.find('*');
    if (star != std::string::npos) {
        std::size_t width = 0;
        while (star + width < name.size() && name[star + width] == '*') {
            ++width;
        }
        std::string digits = std::to_string(number);
        digits.insert(0, width - std::min(width, digits.size()), '0');
        name.replace(star, width, digits);
    }
    result.path = path_.parent_path() / name;
    return result;
}

/// "[time set] [file set] name": numbers in front are sets, as long as enough words remain.
void CaseReader::take_sets(std::vector<std::string>& words, std::size_t least, Pattern& pattern) const {
    for (int numbers = 0; words.size() > least && core::parse_integer(words.front()) && numbers < 2; ++numbers) {
        (numbers == 0 ? pattern.time_set : pattern.file_set) = whole(words.front());
        words.erase(words.begin());
    }
}

/// A line that is not understood is lost: better said than found missing.
bool CaseReader::is_known(const std::string& section, const std::string& key, std::string_view line) {
    const auto known = known_keys.find(section);
    // Lists of numbers go on in lines without a key.
    if (known == known_keys.end() || (section == "TIME" && key.empty() && listing_ != Listing::none) ||
        std::find(known->second.begin(), known->second.end(), key) != known->second.end()) {
        return true;
    }
    const std::string word = key.empty() ? std::string(line.substr(0, 60)) : key;
    const std::string near = core::nearest_name(word, known->second);
    result_.problems.push_back({core::Problem::Severity::warning,
                                "'" + word + "' is not known under " + section + " and passed over" +
                                    (near.empty() ? "" : "; did you mean '" + near + "'?"),
                                {path_.string(), line_, {}, {}}});
    return false;
}

void CaseReader::geometry(const std::string& key, const std::string& rest) {
    if (key != "model") {
        return;  // measured, match, boundary, rigid_body: particles and the like
    }
    auto words = ensight_words(rest);
    take_sets(words, 1, geometry_);
    if (words.empty()) {
        fail("the model has no file name");
    }
    geometry_.name = words.front();
    if (words.size() > 1 && core::lower_case(words[1]) == "change_coords_only") {
        coordinates_only_ = words.size() > 2 ? std::max(0, whole(words[2])) : 0;
    }
}

namespace {

/// "complex scalar per node: 1 pressure FILE_RE FILE_IM 50": what is not read of it, and why.
std::string unread_variable(const std::string& key, const std::vector<std::string>& words) {
    if (!key.starts_with("complex")) {
        return "variables '" + key + "' are not read";
    }
    const std::string name = words.size() >= 4 ? words[words.size() - 4] : words.empty() ? "" : words.front();
    return "the complex variable '" + name +
           "' is not read: it is an amplitude and a phase over frequency, no field at one time";
}

}  // namespace

void CaseReader::variable(const std::string& key, const std::string& rest) {
    auto words = ensight_words(rest);
    if (key.starts_with("constant per case") || key.starts_with("constant per part")) {
        if (words.size() >= 2) {
            result_.constants.emplace_back(words[words.size() - 2], words.back());
        }
        return;
    }
    Pending entry;
    entry.variable.on_nodes = key.ends_with("per node");
    const bool on_elements = key.ends_with("per element");
    entry.variable.components = key.starts_with("scalar")        ? 1
                                : key.starts_with("vector")      ? 3
                                : key.starts_with("tensor symm") ? 6
                                : key.starts_with("tensor asym") ? 9
                                                                 : 0;
    if (entry.variable.components == 0 || (!entry.variable.on_nodes && !on_elements)) {
        result_.problems.push_back(
            {core::Problem::Severity::warning, unread_variable(key, words), {path_.string(), line_, {}, {}}});
        return;
    }
    take_sets(words, 2, entry.pattern);
    if (words.size() < 2) {
        fail("a variable without name or file");
    }
    entry.pattern.name = words.back();
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        entry.variable.name += (i > 0 ? " " : "") + words[i];
    }
    pending_.push_back(std::move(entry));
}

void CaseReader::time(const std::string& key, const std::string& rest, std::string_view line) {
    const auto words = ensight_words(rest);
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
        for (const auto& word : words) {
            set_->values.push_back(real(word));
        }
    } else if (key == "time values file" || key == "filename numbers file") {
        for (const auto& word : ensight_words(core::read_file(path_.parent_path() / first()))) {
            if (key.starts_with("time")) {
                set_->values.push_back(real(word));
            } else {
                set_->numbers.push_back(whole(word));
            }
        }
    } else if (key.empty() && listing_ != Listing::none) {
        for (const auto& word : ensight_words(line)) {
            if (listing_ == Listing::numbers) {
                set_->numbers.push_back(whole(word));
            } else {
                set_->values.push_back(real(word));
            }
        }
    }
}

void CaseReader::files(const std::string& key, const std::string& rest) {
    const auto words = ensight_words(rest);
    const std::string first = words.empty() ? std::string() : words.front();
    if (key == "file set") {
        file_set_ = &file_sets_[whole(first)];
        return;
    }
    if (file_set_ == nullptr) {
        file_set_ = &file_sets_[1];
    }
    if (key == "filename index") {
        file_set_->files.emplace_back(whole(first), 1);
    } else if (key == "number of steps") {
        (file_set_->files.empty() ? file_set_->steps : file_set_->files.back().second) = std::max(1, whole(first));
    }
}

/// All sets of times are looked at at one time: the one asked for, or the last that any of them states.
void CaseReader::choose_time() {
    const auto longest = std::max_element(sets_.begin(), sets_.end(),
                                          [](const auto& a, const auto& b) { return a.second.steps < b.second.steps; });
    if (longest == sets_.end()) {
        if (time_) {
            (void)step_at({}, *time_, path_.string());
        }
        return;
    }
    const TimeSet& set = longest->second;
    if (!set.values.empty() && set.values.size() < static_cast<std::size_t>(set.steps)) {
        fail("the case states " + std::to_string(set.steps) + " steps but " + std::to_string(set.values.size()) +
             " times");
    }
    result_.steps = set.steps;
    if (!set.values.empty()) {
        result_.times.assign(set.values.begin(), set.values.begin() + set.steps);
    }
    if (time_) {
        time_ = result_.times.empty() ? *time_ : result_.times[step_at(result_.times, *time_, path_.string())];
    } else if (!result_.times.empty()) {
        time_ = result_.times.back();
    }
    result_.time = time_;
}

/// The section that a line begins; empty when it begins none.
std::string section_of(std::string_view line) {
    for (const char* name :
         {"FORMAT", "GEOMETRY", "VARIABLE", "TIME", "FILE", "MATERIAL", "BLOCK_CONTINUATION", "SCRIPTS"}) {
        if (core::lower_case(line) == core::lower_case(name)) {
            return name;
        }
    }
    return {};
}

/// Names of files with their numbers filled in, for the chosen time.
void CaseReader::complete_names() {
    result_.geometry = complete(geometry_);
    if (coordinates_only_) {
        result_.connectivity = complete(geometry_, *coordinates_only_);
    }
    for (auto& entry : pending_) {
        entry.variable.file = complete(entry.pattern);
        result_.variables.push_back(std::move(entry.variable));
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
        if (const std::string begun = section_of(line); !begun.empty()) {
            section = begun;
            continue;
        }
        const std::size_t colon = line.find(':');
        const bool keyed = colon != std::string_view::npos;
        const std::string key = keyed ? key_of(line.substr(0, colon)) : std::string();
        const std::string rest(keyed ? core::trimmed(line.substr(colon + 1)) : std::string_view());
        if (!is_known(section, key, line)) {
            continue;
        }
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
        } else if (section == "FILE") {
            files(key, rest);
        }
    }
    choose_time();
    line_ = 0;
    if (!gold || geometry_.name.empty()) {
        throw core::InputError("format", "the case names no geometry in EnSight Gold format",
                               {path_.string(), {}, {}, {}});
    }
    complete_names();
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

EnsightCase read_ensight_case(const std::filesystem::path& path, std::optional<double> time) {
    return CaseReader(path, time).read();
}

}  // namespace underbody::postproc
