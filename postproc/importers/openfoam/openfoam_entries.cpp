// Entries of OpenFOAM dictionaries: what they state is kept, and stands for "$name" further
// down; dimensions.

#include <map>

#include "core/file.h"
#include "core/text.h"
#include "postproc/importers/openfoam/openfoam_input.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_macro = 1000;  // of a macro or an included file

/// The names that OpenFOAM's Foundation line gives (version 10 on), as exponents of kg, m, s, K, mol, A, cd.
std::vector<double> named_dimensions(const std::string& name, const FoamInput& in) {
    static const std::map<std::string, std::vector<double>> known = {{"dimless", {0, 0, 0, 0, 0, 0, 0}},
                                                                     {"length", {0, 1, 0, 0, 0, 0, 0}},
                                                                     {"velocity", {0, 1, -1, 0, 0, 0, 0}},
                                                                     {"pressure", {1, -1, -2, 0, 0, 0, 0}},
                                                                     {"kinematicPressure", {0, 2, -2, 0, 0, 0, 0}},
                                                                     {"density", {1, -3, 0, 0, 0, 0, 0}},
                                                                     {"temperature", {0, 0, 0, 1, 0, 0, 0}},
                                                                     {"energy", {1, 2, -2, 0, 0, 0, 0}},
                                                                     {"kinematicViscosity", {0, 2, -1, 0, 0, 0, 0}},
                                                                     {"dynamicViscosity", {1, -1, -1, 0, 0, 0, 0}},
                                                                     {"force", {1, 1, -2, 0, 0, 0, 0}},
                                                                     {"volume", {0, 3, 0, 0, 0, 0, 0}},
                                                                     {"time", {0, 0, 1, 0, 0, 0, 0}},
                                                                     {"rate", {0, 0, -1, 0, 0, 0, 0}},
                                                                     {"mass", {1, 0, 0, 0, 0, 0, 0}}};
    if (const auto found = known.find(name); found != known.end()) {
        return found->second;
    }
    std::string names;
    for (const auto& [each, exponents] : known) {
        names += (names.empty() ? "" : ", ") + each;
    }
    in.fail("the dimensions '" + name.substr(0, 40) + "' are not known; seven exponents are, and " + names);
}

}  // namespace

void FoamInput::give_up(const std::string& what) const { throw core::InputError(kind_unread, what, place()); }

void FoamInput::push(std::string text, const fs::path& folder) {
    constexpr std::size_t deepest = 50;
    constexpr std::size_t most = std::size_t{16} << 20;
    pushed_bytes_ += text.size();
    if (pushed_.size() >= deepest || pushed_bytes_ > most) {
        give_up("its entries refer to one another without end");
    }
    pushed_.push_back(std::make_unique<Pushed>(std::move(text), folder, file_.name()));
    in_ = &pushed_.back()->stream;
}

void FoamInput::pop() {
    pushed_.pop_back();
    in_ = pushed_.empty() ? &file_ : &pushed_.back()->stream;
}

/// "$name" or "${name}" at the place: what it stands for comes next. False, and nothing taken: it stands for nothing
/// known.
bool FoamInput::substitute() {
    in_->ensure(longest_macro);
    const std::string_view rest(in_->here(), static_cast<std::size_t>(in_->end() - in_->here()));
    const bool braces = rest.substr(1).starts_with('{');
    const std::size_t first = braces ? 2 : 1;
    std::size_t last = first;
    while (last < rest.size() && is_macro_letter(rest[last])) {
        ++last;
    }
    const bool closed = !braces || (last < rest.size() && rest[last] == '}');
    auto text = closed ? entries_.find(std::string(rest.substr(first, last - first))) : std::nullopt;
    if (!text) {
        return false;
    }
    in_->move_to(in_->here() + last + (braces ? 1 : 0));
    push(std::move(*text), folder());
    return true;
}

/// "#include" at the place, of a file of the case: its text comes next. False, and nothing taken: another directive, or
/// a file that is not read.
bool FoamInput::include() {
    in_->ensure(longest_macro);
    const std::string_view rest(in_->here(), static_cast<std::size_t>(in_->end() - in_->here()));
    std::size_t at = 0;
    while (at < rest.size() && static_cast<unsigned char>(rest[at]) > ' ' && rest[at] != '"') {
        ++at;
    }
    const std::string_view word = rest.substr(0, at);
    const std::size_t open = rest.find('"', at);
    const std::size_t close = open == std::string_view::npos ? open : rest.find('"', open + 1);
    const bool plain = word == "#include" || word == "#includeIfPresent" || word == "#sinclude";
    if (!plain || close == std::string_view::npos || !core::trimmed(rest.substr(at, open - at)).empty()) {
        return false;
    }
    const auto file = included_file(std::string(rest.substr(open + 1, close - open - 1)), folder(), case_folder_);
    if (!file) {
        return false;
    }
    in_->move_to(in_->here() + close + 1);
    push(core::read_file(*file), file->parent_path());
    return true;
}

/// A list whose bytes may hold any character: by its count.
void FoamInput::skip_list(std::size_t components, bool whole_numbers) {
    if (whole_numbers) {
        labels();
    } else {
        reals(components);
    }
}

void FoamInput::give_up_at_macro(const std::string& word) const {
    give_up(word.starts_with("$")
                ? "'" + word.substr(0, 40) + "' is not defined in the file, nor in what it includes of the case"
                : "'" + word.substr(0, 40) + "' is computed by OpenFOAM alone");
}

void FoamInput::skip_directive(const std::string& word) {
    if (word.starts_with("#if") || word == "#else" || word == "#endif") {
        give_up_at_macro(word);  // of which branch the rest is, is not known
    }
    token();
}

void FoamInput::expand_macros(const fs::path& case_folder) {
    expanding_ = true;
    case_folder_ = case_folder;
}

fs::path FoamInput::folder() const {
    return pushed_.empty() ? fs::path(file_.name()).parent_path() : pushed_.back()->folder;
}

void FoamInput::define(const std::string& key, const std::string& text) {
    if (expanding_) {
        entries_.define(key, text);
    }
}

void FoamInput::skip_to_end_of_value() {
    for (std::string word = token(); word != ";" || quoted_; word = token()) {
        if (word.empty() && !quoted_) {
            fail("the file ends within a value");
        }
    }
}

void FoamInput::take_entry(const std::string& key) {
    std::string text;
    const bool dictionary = take_rest(key, text, 0);
    define(key, dictionary && text.empty() ? " " : text);
}

/// The rest of an entry. A dictionary's own entries are defined too. True: it was a dictionary.
bool FoamInput::take_rest(const std::string& key, std::string& text, int depth) {
    constexpr int deepest = 100;
    if (!expanding_ || depth > deepest || !accept('{')) {
        skip_entry(&text);
        return false;
    }
    entries_.enter(key);
    for (std::string own = token(); own != "}" || quoted_; own = token()) {
        if (own.empty() && !quoted_) {
            fail("the file ends within an entry");
        }
        if (own == ";") {
            continue;
        }
        const bool quoted = quoted_;
        const bool directive = own.starts_with("#") && !quoted;
        std::string inner;
        const bool dictionary = !directive && take_rest(own, inner, depth + 1);
        if (directive) {
            skip_directive(own);
            continue;
        }
        if (!quoted) {
            define(own, inner);
        }
        text += (quoted ? '"' + own + '"' : own) + (dictionary ? " { " + inner + "}\n" : " " + inner + ";\n");
    }
    entries_.leave();
    return true;
}

void FoamInput::skip_entry(std::string* text) {
    constexpr std::size_t longest_text = 65536;
    int depth = 0;
    for (;;) {
        const std::string word = token();
        if (word.empty() && !quoted_) {
            fail("the file ends within an entry");
        }
        const bool mark = !quoted_;
        if (mark && (word == "{" || word == "(" || word == "[")) {
            ++depth;
        } else if (mark && (word == "}" || word == ")" || word == "]")) {
            if (--depth < 0) {
                fail("'" + word + "' without its beginning");
            }
            if (depth == 0 && word == "}") {
                return;
            }
        } else if (mark && word == ";" && depth == 0) {
            return;
        } else if (word.starts_with("List<") && binary()) {
            const bool whole_numbers = word == "List<label>";
            const std::size_t components = components_of(word);
            if (!whole_numbers && components == 0) {
                fail("a list of unknown type " + word.substr(0, 40));
            }
            skip_list(components, whole_numbers);
        }
        if (text != nullptr && text->size() < longest_text) {
            *text += (text->empty() ? "" : " ") + (mark ? word : '"' + word + '"');
        }
    }
}

std::vector<double> FoamInput::dimensions() {
    std::vector<double> exponents;
    expect("[");
    while (!accept(']')) {
        if (at_letter()) {
            exponents = named_dimensions(token(), *this);
        } else {
            exponents.push_back(number());
        }
        if (exponents.size() > 7) {
            fail("more than seven dimensions");
        }
    }
    expect(";");
    exponents.resize(7);
    return exponents;
}

}  // namespace underbody::postproc
