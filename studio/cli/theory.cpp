// underbody theory: closed forms with units, their limits and their sources.
#include "geometry/water/theory.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/closed_form.h"
#include "core/text.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "surrogates/dynamics/theory/theory.h"
#include "surrogates/estimator/control/theory.h"

namespace underbody::studio {

namespace {

struct Arguments {
    std::string name;
    std::vector<std::string> inputs;
};

std::vector<core::ClosedForm> all_forms() {
    std::vector<core::ClosedForm> all = dynamics::closed_forms();
    all.insert(all.end(), geometry::closed_forms().begin(), geometry::closed_forms().end());
    all.insert(all.end(), estimator::closed_forms().begin(), estimator::closed_forms().end());
    return all;
}

/// What there is, or what one of them takes.
int list(Shell& shell, const std::vector<core::ClosedForm>& forms) {
    nlohmann::json json = nlohmann::json::array();
    std::string text;
    for (const auto& form : forms) {
        nlohmann::json inputs = nlohmann::json::array();
        text += form.name + ": " + form.summary + "\n  " + form.formula + "   (" + form.source + ")\n";
        for (const auto& input : form.inputs) {
            inputs.push_back({{"name", input.name},
                              {"unit", input.unit},
                              {"meaning", input.meaning},
                              {"default", input.usual ? nlohmann::json(*input.usual) : nlohmann::json()}});
            text += "  " + input.name + (input.unit == "1" ? "" : " [" + input.unit + "]") +
                    (input.meaning.empty() ? "" : ": " + input.meaning) +
                    (input.usual ? " (default " + core::format_number(*input.usual, 6) + ")" : "") + "\n";
        }
        json.push_back({{"name", form.name},
                        {"summary", form.summary},
                        {"formula", form.formula},
                        {"source", form.source},
                        {"inputs", inputs}});
    }
    if (shell.json) {
        shell.print_json({{"theories", json}});
    }
    shell.print(text);
    return done;
}

int run(const Arguments& a, Shell& shell) {
    const std::vector<core::ClosedForm> forms = all_forms();
    if (a.name == "list") {
        return list(shell, forms);
    }
    const core::ClosedForm& form = core::find_closed_form(forms, a.name);
    if (a.inputs.empty()) {
        return list(shell, {form});
    }
    const auto values = core::closed_form_values(form, a.inputs);
    const auto result = form.evaluate(values);
    if (shell.json) {
        shell.print_json(core::closed_form_json(form, values, result));
    }
    shell.print(core::closed_form_text(form, values, result));
    return done;
}

}  // namespace

void add_theory_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand(
        "theory", "closed forms: thin films, squeeze damping, jets, added mass, scaling, with their limits");
    auto a = std::make_shared<Arguments>();
    std::string names;
    for (const auto& form : all_forms()) {
        names += (names.empty() ? "" : ", ") + form.name;
    }
    command->add_option("name", a->name, "which: " + names + "; or list, for all of them")->required();
    command->add_option("inputs", a->inputs, "name=value with units, a bare number is SI; none: what this one takes")
        ->expected(-1);
    command->footer(
        "Examples:\n"
        "  underbody theory list\n"
        "  underbody theory squeeze                         what it takes\n"
        "  underbody theory squeeze half_length=71.7mm half_width=53.6mm gap=1mm\n"
        "  underbody theory slider inlet=2mm,outlet=1mm,length=50mm,speed=0.5m/s --json\n"
        "  underbody theory jet_film half_length=71.7mm half_width=53.6mm nozzle_radius=2.5mm flow=20mL/s gap=1mm\n"
        "  underbody theory ellipsoid a=101.6mm b=76mm c=72.5mm mass=2.2kg\n"
        "Each says what it leaves out, and whether that may be left out for these values (\"valid\" in the JSON).");
    shell.on(command, [a, &shell] { return run(*a, shell); });
}

}  // namespace underbody::studio
