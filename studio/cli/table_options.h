// Options that all commands on force tables share: which rows, which quantity, how to fit.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "surrogates/dynamics/model/force_tables.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/line.h"

namespace CLI {
class App;
}

namespace underbody::studio {

class Shell;

struct TableOptions {
    std::string file;
    std::string quantity;
    std::string where;
    std::string axes;
    std::string kind = "automatic";
    std::string range;
    std::string free_axis;   ///< a channel that the caller moves along: the conditions of a model do not hold it
    bool print_held = true;  ///< what a model's forces are held at goes to stdout, above the numbers
    bool at_rest = false;  ///< of a model the caller takes all that acts at rest: no word of effects beside the forces

    /// Adds TABLE.csv, --quantity, --where, --axes, --kind, --range.
    void add_to(CLI::App& command);
    [[nodiscard]] tables::FitOptions fit_options() const;
    /// The rows that were asked for; of a model (.toml) its forces as points. Remarks go to the shell.
    [[nodiscard]] core::Table points(Shell& shell) const;
    /// Is the file a model? Then its forces are taken as it simulates them, not fitted.
    [[nodiscard]] bool is_model() const;
    /// Fits one quantity: the one asked for, or the first force of the table. Remarks go to the shell.
    /// Of a model, `asked` has the values that the caller gives beside --where: those that no table has as an axis
    /// (what only scales the forces) are held and taken off the list.
    [[nodiscard]] tables::ForceTable fit(Shell& shell, tables::Held* asked = nullptr) const;
    /// All quantities asked for ("a,b"), or all forces of the table.
    /// `remarks`: false for who prints them beside each table.
    [[nodiscard]] std::vector<tables::ForceTable> fit_all(Shell& shell, bool remarks = true,
                                                          tables::Held* asked = nullptr) const;
    /// Adds `held` (what the forces of a model are taken at beside their axes, and whence) and `warnings` to the JSON
    /// of a command; of a table its `warnings`, `points_exact`: whether its points state no errors and are taken as
    /// exact, and `points_scatter`: what is taken as their error where they state none.
    void describe(nlohmann::json& document) const;
    /// What a model is held at by --where.
    [[nodiscard]] dynamics::Conditions conditions() const;

private:
    /// Those that the caller fitted from the file before; nullptr: none.
    [[nodiscard]] const std::vector<tables::ForceTable>* fitted(const Shell& shell) const;
    /// The forces of a model; only the first quantity when `one`.
    [[nodiscard]] std::vector<tables::ForceTable> of_model(Shell& shell, bool one, bool remarks,
                                                           tables::Held* asked) const;
    mutable std::vector<dynamics::HeldChannel> held_;  ///< of the model last taken
    mutable core::Problems warnings_;
    /// Says, beside the numbers, what is taken for errors that points do not state.
    void say_unstated(Shell& shell, const tables::ForceTable& table) const;
    mutable std::string said_;    ///< about what is held, once
    mutable bool exact_ = false;  ///< points of a table that was fitted state no errors
    mutable double scatter_ = 0;  ///< the largest that is taken as the error of such points
};

/// A value in the unit that the user's file has for the quantity.
std::string shown(const tables::ForceTable& table, const std::string& quantity, const std::string& si, double value,
                  int digits = 5);

/// "gap=5mm,pitch=1deg" as name and SI value.
std::vector<std::pair<std::string, double>> read_assignments(const std::string& text);

}  // namespace underbody::studio
