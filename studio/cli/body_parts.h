// Parts of `underbody body`: what its sub-commands share, and their registration.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "core/text.h"
#include "core/water.h"
#include "geometry/body/body_report.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

/// A number with at most `digits` significant digits.
inline std::string rounded(double value, int digits = 6) { return core::format_number(value, digits); }

/// Of the water, where nobody says: "998 kg/m^3".
inline std::string default_density() { return core::format_number(core::default_water_density) + " kg/m^3"; }

/// The options of the sub-commands that take one body.
struct BodyInput {
    std::string shape, unit, gap, pitch, roll, density = default_density();
    double feature_angle = 20;
    std::size_t triangles = 20000;
    std::size_t panels = 1200;

    /// The body itself; `required` unless the command has sub-commands that take other words.
    void add_to(CLI::App* command, bool required);
    void add_placement(CLI::App* command);
    /// Empty without --gap; core::UsageError when --pitch or --roll stand alone.
    [[nodiscard]] std::optional<geometry::Placement> placement() const;
    /// What to know of a --gap without a unit that is metres and far beyond the body; empty when all is well.
    [[nodiscard]] std::string doubt(const geometry::SurfaceMesh& body) const;
    [[nodiscard]] geometry::BodyOptions options() const;
};

/// The sub-commands' actions: CLI11 calls back the parent too, which must then stand back.
using BodyActions = std::map<CLI::App*, std::function<int()>>;
void on(Shell& shell, BodyActions& actions, CLI::App* command, std::function<int()> action);

void add_body_compare(CLI::App* body, Shell& shell, BodyActions& actions);
void add_body_sweep(CLI::App* body, Shell& shell, BodyActions& actions);
void add_body_added_mass(CLI::App* body, Shell& shell, BodyActions& actions);
void add_body_domain(CLI::App* body, Shell& shell, BodyActions& actions);

}  // namespace underbody::studio
