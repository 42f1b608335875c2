#include "cases/measured/studies.h"

#include <cctype>
#include <map>

#include "cases/measured/foreign_table.h"
#include "core/file.h"
#include "core/html.h"
#include "core/text.h"
#include "core/water.h"
#include "surrogates/discovery/wording.h"

namespace underbody::cases {

namespace {

discovery::DiscoverOptions quick() {
    discovery::DiscoverOptions options;
    options.horizon = 1;
    options.consequence = false;
    return options;
}

constexpr double kilogram_per_ounce = 0.0283495;

/// Masses by the name of the drops, kg, from balls.txt of the data's owner (ounces; '??' where a ball was not weighed:
/// left out).
std::map<std::string, double> ball_masses(const std::filesystem::path& file) {
    static const std::map<std::string, std::string> listed_as{{"Baseball", "baseball"},
                                                              {"Golf Ball", "golfball"},
                                                              {"Bowling Ball", "bowlingball"},
                                                              {"Tennis Ball", "tennisball"},
                                                              {"Volleyball", "volleyball"},
                                                              {"Blue Basketball", "bluebasketball"},
                                                              {"Green Basketball", "greenbasketball"},
                                                              {"Whiffle Ball 1", "wiffleball1"},
                                                              {"Whiffle Ball 2", "wiffleball2"},
                                                              {"Yellow Whiffle Ball", "yellowWiffle"},
                                                              {"Orange Whiffle Ball", "orangeWiffle"}};
    std::map<std::string, double> ounces;
    const std::string text = core::read_file(file);
    for (const std::string_view line : core::split(text, '\n')) {
        std::vector<std::string> cells;
        for (const std::string_view cell : core::split(line, ' ')) {
            if (!core::trimmed(cell).empty()) {
                cells.emplace_back(core::trimmed(cell));
            }
        }
        if (cells.size() > 1 && core::parse_number(cells[1])) {
            ounces[cells[0]] = *core::parse_number(cells[1]);
        }
    }
    std::map<std::string, double> masses;
    for (const auto& [drop, name] : listed_as) {
        if (ounces.count(name) > 0) {
            masses[drop] = kilogram_per_ounce * ounces.at(name);
        }
    }
    return masses;
}

}  // namespace

std::vector<MeasuredStudy> ball_drop_studies(const std::filesystem::path& folder, core::Progress& progress) {
    const ForeignTable drops = read_foreign(folder / "ball_drops" / "ball_drops.csv");
    const std::size_t ball = drops.column("ball"), drop = drops.column("drop"), time = drops.column("t_s"),
                      height = drops.column("h_m");
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
    const std::map<std::string, double> masses = ball_masses(folder / "ball_drops" / "balls.txt");
    std::vector<MeasuredStudy> studies;
    for (const auto& [name, both] : runs) {
        // a fall knows only forces by mass: a ball that was not weighed falls as one of a kilogram
        const bool weighed = masses.count(name) > 0;
        const double mass = weighed ? masses.at(name) : 1;
        const dynamics::Model model =
            dynamics::read_model_text("[vehicle]\nmass = " + core::format_number(mass) +
                                          "\nnet_weight = " + core::format_number(mass * core::standard_gravity) +
                                          "\n[environment]\ndensity = 1.2\n"
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
        study.declared =
            weighed ? "weight alone, no drag" : "weight alone, no drag; not weighed: forces for a mass of 1 kg";
        study.known =
            name == "Bowling Ball" || name == "Golf Ball" ? "drag is next to nothing" : "drag, its order undecided";
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

void write_measured_reports(const std::vector<MeasuredStudy>& studies, const std::filesystem::path& folder,
                            const discovery::FigureRenderer& renderer) {
    std::filesystem::create_directories(folder);
    core::HtmlPage page("What simple models lack",
                        "measurements of others, each against the simplest model that somebody would declare");
    page.section("Overview");
    std::vector<std::vector<std::string>> rows;
    for (const MeasuredStudy& study : studies) {
        const discovery::ErrorChange& error = study.found.error.front();
        rows.push_back({study.name, study.declared, discovery::verdict_names(study.found),
                        core::format_number(error.before.rmse, 3) + " to " + core::format_number(error.after.rmse, 3) +
                            " " + error.unit,
                        study.known});
    }
    page.table({"study", "declared", "verdict", "held-out error", "what is known"}, rows);
    for (const MeasuredStudy& study : studies) {
        std::string slug;
        for (const char letter : study.name) {
            slug += std::isalnum(static_cast<unsigned char>(letter)) != 0
                        ? static_cast<char>(std::tolower(static_cast<unsigned char>(letter)))
                        : '-';
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
