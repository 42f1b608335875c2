#include "cases/measured/studies.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>

#include "cases/measured/foreign_table.h"
#include "core/file.h"
#include "core/html.h"
#include "core/text.h"

namespace underbody::cases {

namespace {

discovery::DiscoverOptions quick() {
    discovery::DiscoverOptions options;
    options.horizon = 1;
    options.consequence = false;
    return options;
}

/// Masses by ball, kg, as in balls.txt (ounces) of the data's owner; balls without a weight there are left out.
const std::map<std::string, double>& ball_masses() {
    static const std::map<std::string, double> masses{{"Baseball", 5},   {"Golf_Ball", 1.62}, {"Bowling_Ball", 81}, {"Tennis_Ball", 2},
                                                      {"Blue_Basketball", 18}, {"Green_Basketball", 16}};
    return masses;
}

}  // namespace

std::filesystem::path measured_folder(const std::filesystem::path& beside) {
    const char* named = std::getenv("UNDERBODY_SHARED");
    for (const std::filesystem::path& root : {std::filesystem::path(named != nullptr ? named : ""), beside, std::filesystem::path("../shared")}) {
        if (!root.empty() && std::filesystem::is_directory(root / "measured")) {
            return root / "measured";
        }
    }
    return {};
}

std::vector<MeasuredStudy> ball_drop_studies(const std::filesystem::path& folder, core::Progress& progress) {
    const ForeignTable drops = read_foreign(folder / "ball_drops" / "ball_drops.csv");
    const std::size_t ball = drops.column("ball"), drop = drops.column("drop"), time = drops.column("t_s"), height = drops.column("h_m");
    std::map<std::string, std::map<std::string, std::pair<std::vector<double>, std::vector<double>>>> runs;
    for (std::size_t row = 0; row < drops.rows.size(); ++row) {
        auto& [t, h] = runs[drops.rows[row][ball]][drops.rows[row][drop]];
        const double value = drops.number(row, height);
        // the throw from the hand and the bounce on the ground are not the fall
        if (value > 1.0 && drops.number(row, time) > 0.4) {
            t.push_back(drops.number(row, time));
            h.push_back(value);
        }
    }
    std::vector<MeasuredStudy> studies;
    for (const auto& [name, both] : runs) {
        std::string key = name;
        std::replace(key.begin(), key.end(), ' ', '_');
        const auto ounces = ball_masses().find(key);
        if (ounces == ball_masses().end()) {
            continue;
        }
        const double mass = 0.0283495 * ounces->second;
        const dynamics::Model model = dynamics::read_model_text("[vehicle]\nmass = " + core::format_number(mass) + "\nnet_weight = " +
                                                                    core::format_number(mass * 9.80665) + "\n[environment]\ndensity = 1.2\n"
                                                                    "kinematic_viscosity = 1.5e-5\n",
                                                                "ball", ".");
        dynamics::Measurements data;
        data.title = "ball drops, " + name;
        for (const auto& [number, run] : both) {
            dynamics::MeasuredRun one;
            one.name = name + " " + number;
            one.table.source = drops.source;
            one.table.add_numbers("time", "s", run.first);
            one.table.add_numbers("gap", "m", run.second);
            data.runs.push_back(std::move(one));
        }
        MeasuredStudy study;
        study.name = "ball drops: " + name;
        study.data = "ball_drops.csv, B. de Silva et al. 2020, MIT";
        study.declared = "weight alone, no drag";
        study.known = mass > 1 || key == "Golf_Ball" ? "drag is next to nothing" : "drag, its order undecided";
        study.found = discovery::discover(model, data, quick(), progress);
        study.model = model;
        study.measured = std::move(data);
        studies.push_back(std::move(study));
    }
    return studies;
}

std::vector<MeasuredStudy> measured_studies(const std::filesystem::path& folder, core::Progress& progress) {
    std::vector<MeasuredStudy> all;
    if (std::filesystem::is_directory(folder / "rm2_tow_tank")) {
        all.push_back(bearing_study(folder, progress));
        all.push_back(strut_study(folder, progress));
    }
    if (std::filesystem::is_directory(folder / "mashcon2009_bank")) {
        for (MeasuredStudy& study : bank_studies(folder, progress)) {
            all.push_back(std::move(study));
        }
    }
    if (std::filesystem::is_directory(folder / "cf21_thrust_stand")) {
        all.push_back(thrust_stand_study(folder, progress));
    }
    if (std::filesystem::is_directory(folder / "air_garage_ceiling")) {
        all.push_back(ceiling_study(folder, progress));
    }
    if (std::filesystem::is_directory(folder / "ball_drops")) {
        for (MeasuredStudy& study : ball_drop_studies(folder, progress)) {
            all.push_back(std::move(study));
        }
    }
    return all;
}

void write_measured_reports(const std::vector<MeasuredStudy>& studies, const std::filesystem::path& folder, const discovery::FigureRenderer& renderer) {
    std::filesystem::create_directories(folder);
    core::HtmlPage page("What simple models lack", "measurements of others, each against the simplest model that somebody would declare");
    page.section("Overview");
    std::vector<std::vector<std::string>> rows;
    for (const MeasuredStudy& study : studies) {
        const discovery::ErrorChange& error = study.found.error.front();
        rows.push_back({study.name, study.declared, study.found.verdict,
                        core::format_number(error.before.rmse, 3) + " to " + core::format_number(error.after.rmse, 3) + " " + error.unit, study.known});
    }
    page.table({"study", "declared", "verdict", "held-out error", "what is known"}, rows);
    for (const MeasuredStudy& study : studies) {
        std::string slug;
        for (const char letter : study.name) {
            slug += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? static_cast<char>(std::tolower(static_cast<unsigned char>(letter))) : '-';
        }
        discovery::write_discovery(study.found, study.model, study.measured, folder / slug, renderer);
        page.section(study.name);
        page.paragraph(study.found.sentence);
        page.paragraph("Known: " + study.known + ". Data: " + study.data + ".");
        page.link(slug + "/report.html", "the report");
    }
    core::write_file(folder / "index.html", page.text());
}

}  // namespace underbody::cases
