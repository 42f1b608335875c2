#include "cases/measured/studies.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "core/file.h"
#include "core/text.h"

namespace underbody::cases {

namespace {

/// A plain CSV of somebody else: no units in its header. Text stays text.
struct ForeignTable {
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::string source;

    [[nodiscard]] std::size_t column(const std::string& name) const {
        const auto found = std::find(header.begin(), header.end(), name);
        if (found == header.end()) {
            throw core::InputError("name", "no column '" + name + "'", core::Place{source, 1, {}, {}}, core::did_you_mean(name, header));
        }
        return static_cast<std::size_t>(found - header.begin());
    }
    [[nodiscard]] double number(std::size_t row, std::size_t column_index) const {
        const auto value = core::parse_number(rows[row][column_index]);
        if (!value) {
            throw core::InputError("parse", "'" + rows[row][column_index] + "' is not a number",
                                   core::Place{source, static_cast<std::int64_t>(row) + 2, static_cast<std::int64_t>(column_index) + 1, {}});
        }
        return *value;
    }
};

ForeignTable read_foreign(const std::filesystem::path& file) {
    ForeignTable table;
    table.source = file.string();
    const std::string text = core::read_file(file);
    for (const std::string_view line : core::split(text, '\n')) {
        if (core::trimmed(line).empty()) {
            continue;
        }
        std::vector<std::string> cells;
        for (const std::string_view cell : core::split(line, ',')) {
            cells.emplace_back(core::trimmed(cell));
        }
        if (table.header.empty()) {
            table.header = std::move(cells);
        } else if (cells.size() == table.header.size()) {
            table.rows.push_back(std::move(cells));
        } else {
            throw core::InputError("parse", "a line with another number of columns than the header",
                                   core::Place{table.source, static_cast<std::int64_t>(table.rows.size()) + 2, {}, {}});
        }
    }
    return table;
}

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
        studies.push_back(std::move(study));
    }
    return studies;
}

MeasuredStudy bearing_study(const std::filesystem::path& folder, core::Progress& progress) {
    const ForeignTable tare = read_foreign(folder / "rm2_tow_tank" / "Tare-torque.csv");
    const std::size_t rpm = tare.column("rpm"), torque = tare.column("tare_torque");
    std::vector<double> speed, moment, gap, time;
    double above = 0, below = 0;
    for (std::size_t row = 0; row < tare.rows.size(); ++row) {
        speed.push_back(tare.number(row, rpm) * 0.10471975511965977);   // rad/s; in the channel `speed`, of a point one metre out
        moment.push_back(tare.number(row, torque));
        gap.push_back(0.5);
        time.push_back(static_cast<double>(row));
        above += speed.back() * moment.back();
        below += speed.back() * speed.back();
    }
    const core::TemporaryFolder scratch("bearing");
    const std::string slope = core::format_number(above / below);
    core::write_file(scratch.path() / "torque.csv", "gap [m], yaw_moment [N m]\n0, " + slope + "\n1, " + slope + "\n");
    core::write_file(scratch.path() / "model.toml", "[vehicle]\nmass = 1\n[[force]]\nquantity = \"yaw_moment\"\ntable = \"torque.csv\"\n"
                                                    "scale.speed = { reference = 1, exponent = 1 }\n");
    dynamics::Measurements data;
    data.kind = dynamics::MeasurementKind::steady;
    data.title = "bearing of a tow-tank turbine";
    dynamics::MeasuredRun run;
    run.name = "tare";
    run.table.source = tare.source;
    run.table.add_numbers("gap", "m", gap);
    run.table.add_numbers("speed", "m/s", speed);
    run.table.add_numbers("yaw_moment", "N m", moment);
    data.runs.push_back(std::move(run));
    MeasuredStudy study;
    study.name = "bearing";
    study.data = "Tare-torque.csv, UNH-CORE RM2 tow tank, CC BY 4.0, doi:10.6084/m9.figshare.1373899";
    study.declared = "torque proportional to the shaft's speed, slope by least squares";
    study.known = "Coulomb friction, with a slope that falls";
    study.found = discovery::discover(dynamics::read_model(scratch.path() / "model.toml"), data, quick(), progress);
    return study;
}

}  // namespace underbody::cases
