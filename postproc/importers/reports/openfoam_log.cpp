#include "postproc/importers/reports/openfoam_log.h"

#include <set>

#include "core/text.h"
#include "postproc/importers/reports/report_words.h"
#include "postproc/importers/reports/residual_history.h"

namespace underbody::postproc {

namespace {

constexpr std::string_view solving = "Solving for ";
constexpr std::string_view residual = "Initial residual = ";

}  // namespace

bool has_openfoam_residuals(std::string_view text) {
    const auto at = text.find(solving);
    return at != std::string_view::npos && text.substr(at, 256).find(residual) != std::string_view::npos;
}

Monitor read_openfoam_log(const std::string& file, std::string_view text) {
    ResidualHistory residuals(file);
    std::set<std::string> solved;  // in this time step
    for (const auto raw : core::split(text, '\n')) {
        const auto line = core::trimmed(raw);
        if (line.starts_with("Time = ")) {
            const auto word = line.substr(7, line.find_first_of(" s\t", 7) - 7);
            if (const auto time = core::parse_number(word)) {
                residuals.begin(*time);
                solved.clear();
            }
            continue;
        }
        const auto name = line.find(solving);
        const auto value = line.find(residual);
        if (name == std::string_view::npos || value == std::string_view::npos || !residuals.at()) {
            continue;
        }
        const std::size_t begin = name + solving.size();
        const std::string equation(line.substr(begin, line.find(',', begin) - begin));
        const std::string_view rest = line.substr(value + residual.size());
        if (const auto number = number_of(rest.substr(0, rest.find_first_of(", ")));
            number && solved.insert(equation).second) {
            residuals.add(equation, *number);
        }
    }
    const bool transient = text.find("Courant Number") != std::string_view::npos;
    return residuals.finish(transient ? "Time" : "Iteration");
}

}  // namespace underbody::postproc
