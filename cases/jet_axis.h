// A jet as an axis of a sweep or of a search: by its flow, or by the voltage of its pump.
#pragma once

#include <string>
#include <vector>

#include "cases/case_mesh.h"
#include "cases/conditions.h"
#include "core/file_format.h"
#include "core/toml.h"

namespace underbody::cases {

struct JetAxis {
    std::string quantity;        ///< "jet_flow" (m^3/s) or "jet_voltage" (V); empty: no jet
    std::vector<double> values;  ///< as the file has them, SI
    /// Flow of a voltage: flow_per_volt (V - dead_band), none below. Thrust, which goes with the square of the flow, is
    /// then the thesis's law over V^2, or with a dead band the one over (V - 1.54 V)^2 (docs/physics.md, section 5.1).
    double flow_per_volt = 0, dead_band = 0;

    [[nodiscard]] bool any() const { return !values.empty(); }
    [[nodiscard]] std::size_t count() const { return values.empty() ? 1 : values.size(); }
    [[nodiscard]] std::string unit() const { return quantity == "jet_voltage" ? "V" : "m^3/s"; }
    /// m^3/s of a case with these conditions; 0 without a jet.
    [[nodiscard]] double flow(const Conditions& conditions) const;
    /// What a case's name says of it: "-q50" (mL/s), "-v12" (V).
    [[nodiscard]] std::string ending(double value) const;
    /// Throws core::InputError: a jet, and a mesh that has no opening for it.
    void check(const CaseMesh& mesh, const core::Place& place) const;
};

/// Throws core::InputError with the place: flow and voltage at once, a voltage without its law, a law without a
/// voltage, what is negative or not finite, a value twice.
JetAxis read_jet_axis(const core::TomlTable& table);
/// The keys, for the format of a file.
std::vector<core::FileKey> jet_axis_keys();

}  // namespace underbody::cases
