#include "cases/why_names.h"

#include <regex>

#include "cases/export_files.h"
#include "core/file.h"

namespace underbody::cases {

namespace fs = std::filesystem;

std::string file_of(const Name& name) {
    const auto& [kind, of] = name;
    if (kind == "model") {
        return "models/" + of + "/model.toml";
    }
    const auto as = of.rfind(" as ");
    return kind != "export" || as == std::string::npos ? ""
                                                       : "exports/" + export_file(of.substr(0, as), of.substr(as + 4));
}

std::string bare(std::string what) {
    std::erase(what, '\'');
    for (const std::string_view folder : {"./", "report/"}) {
        if (what.starts_with(folder)) {
            what.erase(0, folder.size());
        }
    }
    return what;
}

bool is_called(const Name& name, const std::string& what) {
    const std::string file = file_of(name);
    const bool in_file = !file.empty() && (what == file || what == fs::path(file).filename().string());
    return shown(name) == what || name.second == what || in_file;
}

namespace {
/// The text behind the first `word`, as much as a line of a head may hold.
std::string behind(const std::string& bytes, const std::string& word) {
    const auto at = bytes.find(word);
    return at == std::string::npos ? "" : bytes.substr(at + word.size(), 300);
}

}  // namespace

Head head_of(const fs::path& file) {
    Head head;
    const std::string bytes = core::read_file(file);
    std::smatch found;
    static const std::regex result("^([a-z]+)/([^\n]{1,200}?) ([0-9a-f]{16})");
    std::string line = behind(bytes, "Result: ");
    head.again = line.empty();
    line = head.again ? behind(bytes, "Which holds result: ") : line;
    if (std::regex_search(line, found, result)) {
        head.result = {found[1], found[2]};
        head.id = found[3];
    }
    static const std::regex content("^([0-9a-f]{16,})\\)");
    line = behind(bytes, "(content ");
    if (std::regex_search(line, found, content)) {
        head.content = found[1];
    }
    return head;
}

}  // namespace underbody::cases
