// What a variable is that a file names without its unit, with what the caller states.
#pragma once

#include <string>

#include "core/units.h"
#include "postproc/field/field.h"

namespace underbody::postproc {

struct VariableReading {
    std::string own;            ///< the file's name, without a unit behind it
    std::string name;           ///< canonical, or the file's own
    std::string unit;           ///< SI; empty when nobody says
    std::string original_unit;  ///< as stated by the caller or behind the name
    core::Conversion convert;   ///< from the file's numbers to SI, and to our sign
};

/// SI is taken, or the unit behind the name ("Pressure [ Pa ]"), or before both that in `options.units`, which may make
/// another quantity of it: pressure in m^2/s^2 is kinematic_pressure. OpenFOAM's `wallShearStress` follows the unit
/// stated for `p`, and is turned round: it acts on the fluid there, on the body here. Throws core::InputError for a
/// unit that is none; `problems` gets what `settled_unit` says. `in_file`: the unit that the file states elsewhere.
VariableReading read_variable_name(const std::string& original, const ReadOptions& options, const core::Place& place,
                                   core::Problems& problems, const std::string& in_file = {});

/// What a variable of this meaning is whose numbers are in `unit`: of another dimension than the meaning has it is
/// kinematic or goes by its own name. Throws core::InputError for a unit that is none.
VariableReading quantity_in(const std::string& own, const CanonicalName& meaning, const std::string& unit,
                            const core::Place& place);

/// The unit of a variable that goes by `own` in the file: as the caller states it in `options.units`, else `in_file`,
/// which may be "". Where the two differ the caller's is taken, in all formats, and a warning says so.
std::string settled_unit(const std::string& own, const std::string& in_file, const ReadOptions& options,
                         const core::Place& place, core::Problems& problems);

/// Does the caller state a unit for a variable of this name? Small and large letters are alike where nothing has the
/// very name.
bool is_unit_stated(const ReadOptions& options, const std::string& variable);

/// The name of a variable that is not what its name says, in `unit` ("": nobody says): nobody may take it for that.
std::string own_name(const std::string& own, const std::string& unit);

/// OpenFOAM's `p` and `wallShearStress` are Pa in compressible cases and m^2/s^2 in incompressible ones, under the same
/// names. EnSight, VTK and Tecplot files do not say which: true for such a name while `options` does not either.
bool unit_must_be_stated(const std::string& original, const ReadOptions& options);
/// The name that such a variable goes by, so that nobody takes it for a pressure: "p (unit not stated)".
std::string unstated_name(const std::string& original);
/// The other way: the name in the file; a name of another kind is itself.
std::string name_in_file(const std::string& name);
/// The warning that goes with it.
core::Problem unit_is_asked_for(const std::string& original, const core::Place& place);

}  // namespace underbody::postproc
