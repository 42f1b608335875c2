#include "cases/ask_cfd.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/sweep.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/quantile.h"
#include "core/text.h"
#include "core/toml.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// The text with the name in the list `bodies` of [sweep]; unchanged where that has none (then all bodies are meant).
std::string with_body(std::string text, const std::string& name, const fs::path& file) {
    std::size_t at = 0;
    bool in_sweep = false;
    while (at < text.size()) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view line = core::trimmed(std::string_view(text).substr(at, end - at));
        if (line.starts_with("[")) {
            in_sweep = line.starts_with("[sweep]");
        }
        if (in_sweep && line.starts_with("bodies") && line.find('=') != std::string_view::npos) {
            const std::size_t open = text.find('[', at);
            const std::size_t close = open == std::string::npos ? open : text.find(']', open);
            if (close == std::string::npos) {
                throw core::InputError("format", "the list of bodies of [sweep] cannot be added to",
                                       {file.string(), {}, {}, {}}, "write it as bodies = [\"a\", \"b\"]");
            }
            std::size_t last = close;  // before the space and a comma at its end
            while (last > open + 1 && std::string_view(" \n\t,").find(text[last - 1]) != std::string_view::npos) {
                --last;
            }
            text.insert(last, (last > open + 1 ? ", " : "") + core::toml_string(name));
            return text;
        }
        at = end + 1;
    }
    return text;
}

/// Seconds of the solved cases of a sweep.
std::vector<double> times_of(const Study& study) {
    std::vector<double> seconds;
    std::error_code none;
    const fs::path folder = study.folder() / (study.sweep ? study.sweep->folder : std::string("runs"));
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        const fs::path marker = entry.path() / solved_marker;
        if (!fs::exists(marker, none)) {
            continue;
        }
        const auto said = nlohmann::json::parse(core::read_file(marker), nullptr, false);
        if (said.is_object() && said.contains("seconds") && said["seconds"].is_number()) {
            seconds.push_back(said["seconds"].get<double>());
        }
    }
    return seconds;
}

std::size_t cases_of_a_body(const SweepSpec& sweep) {
    return std::max<std::size_t>(1, sweep.gaps.size()) * std::max<std::size_t>(1, sweep.pitches.size()) *
           std::max<std::size_t>(1, sweep.speeds.size()) * sweep.jet.count();
}

std::string duration_text(double seconds) {
    return seconds < 90     ? core::format_number(seconds, 2) + " s"
           : seconds < 5400 ? core::format_number(seconds / 60, 2) + " min"
                            : core::format_number(seconds / 3600, 2) + " h";
}

}  // namespace

std::string AskedCfd::cost() const {
    const std::string count = std::to_string(cases) + (cases == 1 ? " case" : " cases");
    return std::isfinite(seconds) ? count + ", about " + duration_text(seconds) + " of one core (median of " +
                                        std::to_string(solved) + " solved here)"
                                  : count + ", how long is not known: none of this sweep is solved yet";
}

AskedCfd ask_for_cfd(const Study& study, const geometry::BodyShape& shape, const std::string& name, double gap,
                     std::optional<double> speed) {
    const fs::path file = study.folder() / "study.toml";
    AskedCfd asked;
    asked.name = name;
    if (name.empty() || name.find_first_of("/\\\n\"") != std::string::npos) {
        throw core::InputError("name", "'" + name + "' is no name of a body", {}, "a word without '/' and quotes");
    }
    for (const auto& body : study.bodies) {
        if (body.name == name) {
            throw core::InputError("exists", "the study has a body '" + name + "' already", {file.string(), {}, {}, {}},
                                   "take another name");
        }
    }
    asked.shape_file = study.folder() / "shapes" / (name + ".toml");
    if (fs::exists(asked.shape_file)) {
        throw core::InputError("exists", "there is such a file already", {asked.shape_file.string(), {}, {}, {}},
                               "take another name");
    }
    geometry::check(shape);
    geometry::BodyShape named = shape;
    named.name = name;
    asked.shape_text = geometry::write_shape(named);
    std::string text = core::read_file(file);
    text += text.ends_with('\n') ? "" : "\n";
    if (study.sweep) {
        text = with_body(std::move(text), name, file);
    } else {
        text += "\n[sweep]\nbodies = [" + core::toml_string(name) + "]\ngap = [\"" +
                core::format_number(1000 * gap, 6) + " mm\"]\n";
        for (const auto& one : study.cases) {  // else that of the first case that has one
            speed = speed ? speed : one.conditions.number("speed");
        }
        text +=
            speed && !study.reference.number("speed") ? "speed = \"" + core::format_number(*speed, 6) + " m/s\"\n" : "";
    }
    text += "\n[[body]]\nname = " + core::toml_string(name) +
            "\nshape = " + core::toml_string("shapes/" + name + ".toml") + "\n";
    asked.study_text = text;
    const Study after = Study::from_text(text, file);  // what is wrong with it is said before it is written
    asked.cases = after.sweep ? cases_of_a_body(*after.sweep) : 0;
    const auto times = times_of(study);
    asked.solved = times.size();
    if (!times.empty()) {
        asked.seconds = core::median(times) * static_cast<double>(asked.cases);
    }
    return asked;
}

void write_asked(const Study& study, const AskedCfd& asked) {
    const core::ReplacingAllowed of_the_user;  // who asked for it
    core::write_file(asked.shape_file, asked.shape_text);
    core::write_file(study.folder() / "study.toml", asked.study_text);
}

}  // namespace underbody::cases
