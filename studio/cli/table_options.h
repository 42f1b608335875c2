// Options that all commands on force tables share: which rows, which quantity, how to fit.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "surrogates/tables/fit/force_table.h"

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

    /// Adds TABLE.csv, --quantity, --where, --axes, --kind, --range.
    void add_to(CLI::App& command);
    [[nodiscard]] tables::FitOptions fit_options() const;
    /// The rows that were asked for; of a model (.toml) its forces as points. Remarks go to the shell.
    [[nodiscard]] core::Table points(Shell& shell) const;
    /// Is the file a model? Then its forces are taken as it simulates them, not fitted.
    [[nodiscard]] bool is_model() const;
    /// Fits one quantity: the one asked for, or the first force of the table. Remarks go to the shell.
    [[nodiscard]] tables::ForceTable fit(Shell& shell) const;
    /// All quantities asked for ("a,b"), or all forces of the table.
    /// `remarks`: false for who prints them beside each table.
    [[nodiscard]] std::vector<tables::ForceTable> fit_all(Shell& shell, bool remarks = true) const;

private:
    /// Those that the caller fitted from the file before; nullptr: none.
    [[nodiscard]] const std::vector<tables::ForceTable>* fitted(const Shell& shell) const;
    /// The forces of a model; only the first quantity when `one`.
    [[nodiscard]] std::vector<tables::ForceTable> of_model(Shell& shell, bool one, bool remarks) const;
};

/// A value in the unit that the user's file has for the quantity.
std::string shown(const tables::ForceTable& table, const std::string& quantity, const std::string& si, double value,
                  int digits = 5);

/// "gap=5mm,pitch=1deg" as name and SI value.
std::vector<std::pair<std::string, double>> read_assignments(const std::string& text);

}  // namespace underbody::studio
