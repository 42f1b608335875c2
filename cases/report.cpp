// The report: one self-contained page that a person wants to read, from the documents of the steps.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "cases/code_version.h"
#include "cases/doubts.h"
#include "cases/engine.h"
#include "cases/excused.h"
#include "cases/percent.h"
#include "cases/report_tables.h"
#include "core/counted.h"
#include "core/html.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/points/settled.h"

namespace underbody::cases {

namespace {

using core::HtmlPage;
using nlohmann::json;

std::string shown(double value, const std::string& from, const std::string& to, int digits = 3) {
    return std::isfinite(value) ? core::format_number(core::convert(value, from, to), digits) : "-";
}

/// A key that a result does not have is a defect of the step that made it.
const json& part_of(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) {
        throw std::logic_error(std::string("a result for the report has no '") + key + "'");
    }
    return *found;
}

/// NaN: not known.
double number_in(const json& object, const char* key) {
    const json& number = part_of(object, key);
    return number.is_null() ? std::nan("") : number.get<double>();
}

std::string text_in(const json& object, const char* key) { return part_of(object, key).get<std::string>(); }

class Report {
public:
    explicit Report(Engine& engine) : engine_(engine), page_(engine.study.title, engine.study.origin) {}

    std::string make() {
        if (!engine_.study.summary.empty()) {
            page_.paragraph(engine_.study.summary);
        }
        key_figures();
        failures();
        warnings();
        bodies();
        fields();
        tables();
        comparisons();
        regions();
        measurements();
        thesis("thesis");
        thesis("dynamics");
        search();
        trust();
        loads();
        provenance();
        return page_.text();
    }

private:
    std::optional<json> document(const std::string& key) const {
        const auto* text = engine_.results.document(key);
        return text != nullptr ? std::optional<json>(json::parse(*text)) : std::nullopt;
    }

    std::optional<HtmlPage::Picture> figure(const std::string& name) const {
        const auto* png = engine_.results.picture("figure/" + name);
        const auto head = document("figure/" + name);
        if (png == nullptr || !head) {
            return std::nullopt;
        }
        return HtmlPage::Picture{*png, text_in(*head, "caption"), text_in(*head, "title")};
    }

    void show_figure(const std::string& name) {
        if (const auto picture = figure(name)) {
            page_.picture(*picture);
        }
    }

    /// The command that walks from the numbers of a result back to all that made them.
    void way_back(const std::string& result) {
        page_.paragraph("Where these numbers come from: underbody study why STUDY \"" + result + "\"");
    }

    void add_stable_gaps(std::vector<HtmlPage::Fact>& facts) {
        for (const auto& spec : engine_.study.tables) {
            const auto* table = find_result(engine_.results.tables, spec.name);
            if (table == nullptr || !spec.net_weight) {
                continue;
            }
            std::string gaps;
            for (const auto& point : table->equilibria) {
                if (point.stable) {
                    gaps += (gaps.empty() ? "" : ", ") + shown(point.gap, "m", "mm", 2) + "\u00a0mm" +
                            (point.doubtful() ? " (with probability " + core::format_number(point.probability, 2) + ")"
                                              : "");
                }
            }
            facts.push_back({gaps.empty() ? "none" : gaps, "stable gaps by '" + spec.name + "' at a net weight of " +
                                                               shown(*spec.net_weight, "N", "N", 3) + " N"});
        }
    }

    void add_missing_effects(std::vector<HtmlPage::Fact>& facts) {
        for (const auto& spec : engine_.study.measurements) {
            if (const auto found = document("discovery/" + spec.name)) {
                std::string names;
                for (const auto& effect : found->value("effects", json::array())) {
                    names += (names.empty() ? "" : ", ") + text_in(effect, "name");
                }
                std::replace(names.begin(), names.end(), '_', ' ');
                facts.push_back({names.empty() ? text_in(*found, "verdict") : names,
                                 "missing in the model of '" + spec.name + "'"});
            }
        }
    }

    void add_claims(std::vector<HtmlPage::Fact>& facts) {
        std::map<std::string, int> counts;
        for (const char* part : {"thesis/thesis", "thesis/dynamics"}) {
            if (const auto thesis = document(part)) {
                for (const auto& claim : thesis->value("claims", json::array())) {
                    ++counts[text_in(claim, "verdict")];
                }
            }
        }
        for (const auto& [verdict, count] : counts) {
            facts.push_back({std::to_string(count), "claims: " + verdict});
        }
    }

    void key_figures() {
        std::vector<HtmlPage::Fact> facts;
        if (!engine_.study.cases.empty()) {
            facts.push_back({std::to_string(engine_.results.loads.rows()), "CFD cases"});
        }
        for (const auto& spec : engine_.study.verifications) {
            if (const auto* check = find_result(engine_.results.verifications, spec.name)) {
                facts.push_back({percent(check->worst, 2), "largest difference from the solver's own " + spec.name});
            }
        }
        add_stable_gaps(facts);
        add_missing_effects(facts);
        add_claims(facts);
        if (!facts.empty()) {
            page_.facts(facts);
        }
    }

    void failures() {
        for (const auto& step : engine_.results.steps) {
            if (!step.error.empty()) {
                page_.warning("Not done: " + step.kind + " '" + step.name + "': " + step.error);
            }
        }
        for (const auto& note : engine_.study.notes) {
            if (note.severity != core::Problem::Severity::note) {
                page_.warning(note.message);
            }
        }
        if (const auto names = tables::not_settled(engine_.results.loads); !names.empty()) {
            std::string list;
            for (const auto& name : names) {
                list += (list.empty() ? "" : ", ") + name;
            }
            page_.warning(core::counted_of(names.size(), engine_.results.loads.rows(), "solution", "has", "have") +
                          " not settled: " + list);
        }
    }

    /// What makes the loads less than they seem, before anybody reads a number.
    void warnings() {
        for (const auto& problem : engine_.results.gathered_warnings()) {
            page_.warning("Loads: " + problem.place.file + ": " + problem.message);
        }
    }

    /// Under its picture, which has its name as title.
    std::string said_of_body(const std::string& name) {
        const auto body = document("body/" + name);
        return body ? shown(number_in(*body, "volume"), "m^3", "L", 4) + " L, buoyancy " +
                          shown(number_in(*body, "buoyancy"), "N", "N", 4) + " N"
                    : name;
    }

    /// What a reader must know stands there; how the curve was fitted is for those who ask.
    void remarks(const std::vector<std::string>& all) {
        std::vector<std::string> plain;
        std::vector<std::vector<std::string>> of_the_fit;
        for (const auto& remark : all) {
            if (remark.starts_with("Gaussian process") || remark.starts_with("interpolated: leave-one-out")) {
                of_the_fit.push_back({remark});
            } else {
                plain.push_back(remark);
            }
        }
        if (!plain.empty()) {
            page_.list(plain);
        }
        if (!of_the_fit.empty()) {
            page_.folded_table("How it was fitted", {"remarks of the fit"}, of_the_fit);
        }
    }

    void bodies() {
        if (engine_.study.bodies.empty()) {
            return;
        }
        page_.section("The body");
        std::vector<std::vector<std::string>> rows;
        std::vector<HtmlPage::Picture> pictures;
        for (const auto& spec : engine_.study.bodies) {
            if (const auto body = document("body/" + spec.name)) {
                const double volume = number_in(*body, "volume");
                rows.push_back({spec.name, shown(volume, "m^3", "L", 4),
                                shown(number_in(*body, "area"), "m^2", "cm^2", 4),
                                shown(number_in(*body, "buoyancy"), "N", "N", 4),
                                body->value("watertight", false) ? "yes" : "no"});
            }
            if (const auto* png = engine_.results.picture("body picture/" + spec.name)) {
                pictures.push_back({*png, said_of_body(spec.name), "the body " + spec.name});
            }
        }
        page_.pictures(pictures);
        page_.table({"body", "volume (L)", "surface (cm²)", "buoyancy (N)", "watertight"}, rows);
    }

    void fields() {
        std::vector<HtmlPage::Picture> pictures;
        for (const auto& spec : engine_.study.pictures) {
            for (const auto& [key, png] : engine_.results.pictures) {
                if (key.starts_with("picture/" + spec.name + "/")) {
                    const auto head = document(key);
                    const std::string rest = key.substr(("picture/" + spec.name + "/").size()),
                                      name = rest.substr(0, rest.find('/'));
                    pictures.push_back(
                        {png, name + ": " + (head ? text_in(*head, "caption") : ""), spec.name + ", " + name});
                }
            }
        }
        if (!pictures.empty()) {
            page_.section("The flow on the surface");
            page_.pictures(pictures);
        }
    }

    void equilibria(const TableResult& table, double net_weight) {
        std::vector<std::vector<std::string>> rows;
        for (const auto& point : table.equilibria) {
            rows.push_back({shown(point.gap, "m", "mm"), point.sigma > 0 ? shown(point.sigma, "m", "mm", 2) : "-",
                            point.stable ? "stable" : "unstable", shown(point.stiffness, "N/m", "N/m"),
                            point.stiffness_sigma > 0 ? shown(point.stiffness_sigma, "N/m", "N/m", 2) : "-",
                            point.stable ? shown(point.frequency, "Hz", "Hz") : "-",
                            point.frequency_sigma > 0 ? shown(point.frequency_sigma, "Hz", "Hz", 2) : "-",
                            point.stable ? shown(point.kick_velocity, "m/s", "mm/s") : "-"});
        }
        std::vector<std::string> header = {"gap (mm)", "± (mm)",         "kind",   "stiffness (N/m)",
                                           "± (N/m)",  "frequency (Hz)", "± (Hz)", "largest kick survived (mm/s)"};
        if (std::any_of(table.equilibria.begin(), table.equilibria.end(), [](const auto& p) { return p.doubtful(); })) {
            header.emplace_back("exists with probability");
            for (std::size_t i = 0; i < rows.size(); ++i) {
                const EquilibriumResult& point = table.equilibria[i];
                rows[i].push_back(point.doubtful() ? core::format_number(point.probability, 2)
                                                   : "> " + core::format_number(tables::sure_enough));
            }
        }
        if (rows.empty()) {
            page_.paragraph("No equilibrium in the table at a net weight of " + shown(net_weight, "N", "N") + " N.");
            return;
        }
        page_.table(header, rows,
                    "Where lift balances a net weight of " + shown(net_weight, "N", "N") +
                        " N. The kick is the upward or downward velocity from which the body still comes back.");
    }

    void tables() {
        if (engine_.study.tables.empty()) {
            return;
        }
        page_.section("Force tables and equilibria");
        for (const auto& spec : engine_.study.tables) {
            const auto* table = find_result(engine_.results.tables, spec.name);
            if (table == nullptr) {
                continue;
            }
            page_.subsection(spec.name);
            show_figure("table/" + spec.name);
            if (spec.net_weight) {
                equilibria(*table, *spec.net_weight);
                const ReportTable films = films_at_equilibria(engine_.study, engine_.results, spec);
                if (!films.rows.empty()) {
                    page_.table(films.header, films.rows, films.caption);
                }
            }
            remarks(table->remarks);
            for (const auto& file : table->exports) {
                page_.link(file.file, "Controller table (" + file.format + "): " + file.file);
            }
            way_back("table/" + spec.name);
        }
    }

    void comparisons() {
        if (engine_.study.comparisons.empty()) {
            return;
        }
        page_.section("Underbodies compared");
        for (const auto& spec : engine_.study.comparisons) {
            show_figure("compare/" + spec.name);
            if (const auto found = document("compare/" + spec.name)) {
                std::vector<std::vector<std::string>> rows;
                for (const auto& row : found->value("rows", json::array())) {
                    rows.push_back({text_in(row, "measure"), text_in(row, "table"), text_in(row, "text")});
                }
                page_.table({"measure", "best", "value"}, rows);
                for (const auto& remark : found->value("remarks", json::array())) {
                    page_.paragraph(remark.get<std::string>());
                }
            }
        }
    }

    void regions() {
        if (engine_.study.regions.empty()) {
            return;
        }
        page_.section("Where it comes back from");
        for (const auto& spec : engine_.study.regions) {
            show_figure("region/" + spec.name);
            if (const auto* region = find_result(engine_.results.regions, spec.name)) {
                std::vector<std::vector<std::string>> rows;
                for (const auto& end : region->ends) {
                    rows.push_back({end.name, end.kind, percent(end.fraction)});
                }
                page_.table({"end of the motion", "kind", "share of the starts"}, rows,
                            std::to_string(spec.columns) + " x " + std::to_string(spec.rows) + " starts, " +
                                core::format_number(spec.duration, 3) + " s of motion each.");
                for (const auto& doubt : doubts_of_model(engine_.study, engine_.results, spec)) {
                    page_.warning(doubt);
                }
                remarks(region->remarks);
                page_.link("models/" + spec.name + "/model.toml",
                           "The model as a file for underbody simulate and region");
                way_back("region/" + spec.name);
            }
        }
    }

    void measurements() {
        if (engine_.study.measurements.empty()) {
            return;
        }
        page_.section("Measured runs against the model");
        for (const auto& spec : engine_.study.measurements) {
            page_.subsection(spec.name);
            if (const auto residual = document("residual/" + spec.name)) {
                for (const auto& line : residual->value("sentences", json::array())) {
                    page_.paragraph(line.get<std::string>());
                }
            }
            for (const auto& warning : warnings_of(spec, engine_.results)) {
                page_.warning(warning);
            }
            std::vector<HtmlPage::Picture> pictures;
            for (int i = 0; i < 8; ++i) {
                if (const auto picture = figure("residual/" + spec.name + "/" + std::to_string(i))) {
                    pictures.push_back(*picture);
                }
            }
            page_.pictures(pictures);
            if (const auto found = document("discovery/" + spec.name)) {
                discovery(*found);
                page_.link("discovery/" + spec.name + "/report.html",
                           "The whole discovery: residuals, alternatives, consequence, next experiment");
            }
        }
    }

    void discovery(const json& found) {
        if (found.contains("sentence")) {
            page_.paragraph(text_in(found, "sentence"));
        }
        std::vector<std::vector<std::string>> rows;
        for (const auto& effect : found.value("effects", json::array())) {
            std::string parameters;
            const json values = effect.value("parameters", json::object());
            for (const auto& [name, value] : values.items()) {
                parameters += (parameters.empty() ? "" : ", ") + name + " = " +
                              core::format_number(number_in(value, "value"), 3) + " ± " +
                              core::format_number(number_in(value, "sigma"), 2) + " " + text_in(value, "unit");
            }
            rows.push_back(
                {text_in(effect, "name"), parameters, core::format_number(number_in(effect, "probability"), 2)});
        }
        if (!rows.empty()) {
            page_.table({"effect the model lacks", "parameters", "probability"}, rows);
        }
        if (const auto error = found.find("error"); error != found.end() && error->contains("before")) {
            const auto& before = error->at("before");
            const auto& after = error->at("after");
            const std::string unit = text_in(*error, "unit");
            const std::string to = unit == "m" ? "mm" : unit == "m/s" ? "mm/s" : unit;
            const auto row = [&](const char* when, const json& one) {
                const auto number = [&](const char* key) { return shown(number_in(one, key), unit, to, 3); };
                return std::vector<std::string>{when, number("rmse"), number("low") + " to " + number("high"), to};
            };
            page_.table({"model", "error", "95 % interval", "unit"},
                        {row("as declared", before), row("as found", after)},
                        "Error of the prediction of the " + text_in(*error, "channel") +
                            " on runs that nothing was fitted to.");
        }
    }

    void thesis(const std::string& part) {
        const auto found = document("thesis/" + part);
        if (!found) {
            return;
        }
        page_.section("The thesis, claim by claim");
        std::vector<std::vector<std::string>> rows;
        for (const auto& claim : found->value("claims", json::array())) {
            rows.push_back({text_in(claim, "where"), text_in(claim, "statement"), text_in(claim, "computed"),
                            text_in(claim, "verdict")});
        }
        page_.table({"where", "the thesis says", "we compute", "verdict"}, rows);
        page_.section("Its figures, drawn from our own runs");
        for (const auto& name : found->value("figure_names", json::array())) {
            if (auto picture = figure("thesis/" + name.get<std::string>())) {
                picture->caption = "Figure " + name.get<std::string>() + ". " + picture->caption;
                page_.picture(*picture);
            }
        }
    }

    /// A search has a page of its own: this one says so, instead of nothing.
    void search() {
        if (!engine_.study.design) {
            return;
        }
        page_.section("The search for a better shape");
        page_.paragraph("Its plan, surrogates, sensitivities and best designs: underbody design report STUDY");
    }

    void verifications() {
        for (const auto& spec : engine_.study.verifications) {
            if (const auto* check = find_result(engine_.results.verifications, spec.name)) {
                const std::string* document = engine_.results.document("verify/" + spec.name);
                const std::string excuse = document == nullptr ? "" : excused(nlohmann::json::parse(*document));
                page_.paragraph("Our loads against the solver's own " + spec.name + " (" +
                                spec.table.filename().string() + "): " + core::counted(check->values, "value") +
                                " compared; beyond twice what the run itself swings by, the worst differs by " +
                                percent_of(check->worst, "the force's size") + " (" + check->worst_case +
                                "); allowed " + percent(check->tolerance) + ", beyond it " +
                                std::to_string(check->failed) + excuse +
                                ". The files hold node values; face values would agree to rounding.");
            }
        }
    }

    void mesh_studies() {
        std::vector<std::vector<std::string>> rows;
        for (const auto& spec : engine_.study.mesh_uncertainties) {
            const auto* mesh = find_result(engine_.results.meshes, spec.name);
            if (mesh == nullptr) {
                continue;
            }
            for (const auto& found : mesh->quantities) {
                std::string values;
                for (const double value : found.values) {
                    values += (values.empty() ? "" : ", ") + core::format_number(value, 3);
                }
                rows.push_back(
                    {spec.name, found.name, values, found.verdict, core::format_number(found.standard_uncertainty, 2)});
            }
        }
        if (!rows.empty()) {
            page_.table(
                {"cases", "quantity", "coarse to fine", "convergence", "standard uncertainty"}, rows,
                "Mesh uncertainty, by the grid convergence index (Celik et al. 2008). Forces in N, moments in N m.");
            for (const auto& spec : engine_.study.mesh_uncertainties) {
                show_figure("mesh/" + spec.name);
            }
        }
    }

    void trust() {
        if (engine_.study.cases.empty()) {
            return;
        }
        page_.section("How far to trust the numbers");
        std::vector<std::string> remarks;
        for (const auto& problem : engine_.results.gathered_warnings()) {
            remarks.push_back(problem.place.file + ": " + problem.message);
        }
        if (!remarks.empty()) {
            page_.paragraph("The loads themselves carry warnings; what stands on them carries these too:");
            page_.list(remarks);
        }
        verifications();
        mesh_studies();
        page_.paragraph(
            "Lift is that of steady RANS on a moving ground. Film models below a millimetre, the jet's voltage law and "
            "separate estimates of lift and drag are uncertain in ways no mesh study shows.");
    }

    void loads() {
        const core::Table& table = engine_.results.loads;
        if (table.rows() == 0) {
            return;
        }
        page_.section("Loads of all cases");
        const ReportTable shown_loads = loads_of_all_cases(engine_.study, engine_.results);
        page_.folded_table(core::counted(shown_loads.rows.size(), "case"), shown_loads.header, shown_loads.rows);
        if (!shown_loads.caption.empty()) {
            page_.paragraph(shown_loads.caption);
        }
        page_.paragraph(
            "Lift positive up, drag against the motion, pitch moment nose up about the centre of the base. "
            "Errors are those that the force tables take for the case (mesh study and stated error); closure is the "
            "size of the summed area vector over the area, 0 for a closed surface. A solution is settled when the "
            "solver's own histories beside the file neither drift nor scatter by more than a twentieth of the force; "
            "unknown where there are none.");
    }

    void provenance() {
        page_.section("How this was made");
        page_.paragraph(
            "Loads, equilibria, points of tables and shares of maps, as this page prints them (\"2.83 mm\") or by name "
            "(\"lift_force of CASE\", \"table/NAME\", exports/FILE): underbody study why STUDY WHAT goes back to "
            "faces, files "
            "with their hashes, mesh, settings of the solver and code.");
        std::vector<std::vector<std::string>> rows;
        for (const auto& [room, version] : code_versions()) {
            rows.push_back({room, version.substr(0, 12)});
        }
        page_.paragraph(
            "By Underbody from study.toml. Every result is kept with the content of all files that were read for it, "
            "the options "
            "and the versions of the code that made it; one of them another, and it is computed again.");
        page_.folded_table("Source versions by module", {"module", "version"}, rows);
        std::vector<std::vector<std::string>> files;
        for (const auto& one : engine_.results.case_loads) {
            files.push_back({one.file, engine_.study.cases[one.entry].conditions.label(), one.origin.substr(0, 12)});
        }
        page_.folded_table("Files of the cases", {"file", "conditions", "all that was read"}, files);
    }

    Engine& engine_;
    HtmlPage page_;
};

}  // namespace

void write_report(Engine& engine) { Engine::write_if_changed(engine.report_file(), Report(engine).make()); }

}  // namespace underbody::cases
