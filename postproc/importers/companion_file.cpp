#include "postproc/importers/companion_file.h"

#include "core/inputs.h"
#include "core/text.h"

namespace underbody::postproc {

namespace fs = std::filesystem;

fs::path partner_by_name(const fs::path& path, const std::vector<std::string>& endings,
                         const std::vector<std::string>& others, bool earlier) {
    const std::string name = path.filename().string();
    std::string stem;
    for (const auto& ending : endings) {
        if (name.size() > ending.size() && core::lower_case(name).ends_with(ending) &&
            name.size() - ending.size() > stem.size()) {
            stem = name.substr(0, name.size() - ending.size());
        }
    }
    while (!stem.empty()) {
        for (const auto& other : others) {
            fs::path candidate = path.parent_path() / (stem + other);
            core::note_presence(candidate);
            std::error_code error;
            if (fs::is_regular_file(candidate, error)) {
                return candidate;
            }
        }
        if (!earlier) {
            break;
        }
        // name-1-00010 -> name-1 -> name
        const std::size_t dash = stem.find_last_of('-');
        if (dash == std::string::npos || dash + 1 == stem.size() ||
            stem.find_first_not_of("0123456789.", dash + 1) != std::string::npos) {
            break;
        }
        stem.resize(dash);
    }
    return {};
}

}  // namespace underbody::postproc
