#include "cases/jet_axis.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace underbody::cases {

double JetAxis::flow(const Conditions& conditions) const {
    const double value = quantity.empty() ? 0 : conditions.number(quantity).value_or(0);
    return quantity == "jet_voltage" ? flow_per_volt * std::max(0.0, value - dead_band) : value;
}

std::string JetAxis::ending(double value) const {
    return quantity == "jet_voltage" ? "-v" + core::format_number(value, 6)
                                     : "-q" + core::format_number(1e6 * value, 6);
}

void JetAxis::check(const CaseMesh& mesh, const core::Place& place) const {
    if (any() && mesh.mesher == "snappy") {
        throw core::InputError("choice", "a jet needs a mesh of blocks", place,
                               "mesher = \"blocks\", without cell, surface_level and layers");
    }
}

JetAxis read_jet_axis(const core::TomlTable& table) {
    JetAxis jet;
    const bool by_flow = table.has("jet_flow"), by_voltage = table.has("jet_voltage");
    if (by_flow && by_voltage) {
        throw core::InputError("choice", table.path_of("jet_voltage") + " and jet_flow are two words for one jet",
                               table.place("jet_voltage"), "one of them");
    }
    const auto positive = [&](const char* key, const char* unit) {
        const double value = table.quantity(key, unit);
        if (!(value > 0)) {
            throw core::InputError("range", table.path_of(key) + " must be above zero", table.place(key),
                                   std::string(key) + " = \"2.2 mL/s/V\"");
        }
        return value;
    };
    if (!by_voltage) {
        for (const char* key : {"jet_flow_per_volt", "jet_dead_band"}) {
            if (table.has(key)) {
                throw core::InputError("missing", table.path_of(key) + " is of a jet_voltage, and there is none",
                                       table.place(key), "jet_voltage = [\"0 V\", \"12 V\"]");
            }
        }
    }
    if (!by_flow && !by_voltage) {
        return jet;
    }
    jet.quantity = by_flow ? "jet_flow" : "jet_voltage";
    if (by_voltage) {
        jet.flow_per_volt = positive("jet_flow_per_volt", "m^3/s/V");
        jet.dead_band = table.quantity_or("jet_dead_band", "V", 0);
    }
    jet.values = table.is_array(jet.quantity) ? table.quantities(jet.quantity, jet.unit())
                                              : std::vector<double>{table.quantity(jet.quantity, jet.unit())};
    std::sort(jet.values.begin(), jet.values.end());
    const char* key = jet.quantity.c_str();
    if (jet.values.empty() || jet.values.front() < 0 || jet.dead_band < 0) {
        const bool of_band = !jet.values.empty() && jet.values.front() >= 0;
        throw core::InputError("range",
                               table.path_of(of_band ? "jet_dead_band" : key) +
                                   (jet.values.empty() ? " is empty" : " is below zero: a nozzle blows"),
                               table.place(of_band ? "jet_dead_band" : key), "the nearest allowed value: 0");
    }
    if (std::adjacent_find(jet.values.begin(), jet.values.end()) != jet.values.end()) {
        throw core::InputError("name", table.path_of(key) + " says a value twice", table.place(key));
    }
    return jet;
}

std::vector<core::FileKey> jet_axis_keys() {
    return {{"jet_flow", "m^3/s or list of m^3/s", "[\"0 mL/s\", \"50 mL/s\"]", "no jet",
             "through the nozzle of the body; blocks only"},
            {"jet_voltage", "V or list of V", "[\"0 V\", \"12 V\"]", "", "of the jet's pump", "jet_flow"},
            {"jet_flow_per_volt", "m^3/s/V", "\"2.2 mL/s/V\"", "", "the flow that each volt above the dead band gives",
             "jet_flow"},
            {"jet_dead_band", "V", "\"1.54 V\"", "0", "up to this voltage nothing flows", "jet_flow"}};
}

}  // namespace underbody::cases
