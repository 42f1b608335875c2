// How the loads of a case are taken, and what is known of their errors.
#pragma once

#include <map>
#include <string>

#include "cases/study.h"
#include "postproc/field/field.h"
#include "postproc/loads/loads.h"

namespace underbody::cases {

/// Zones, axes, symmetry, reference and coefficients as the study says for this case.
/// Throws core::UsageError: axes that are none.
postproc::LoadsOptions loads_options(const Study& study, const Case& entry);

/// How the file of a case is read: with the units that the study says for it.
postproc::ReadOptions read_options(const Case& entry);

/// One standard deviation (SI) of a quantity of each case of which one is known, by the case's name: what the
/// [[table]]s of that quantity give their points (mesh study, stated relative error, scatter), the largest where
/// several do, else the scatter from iteration to iteration alone. A table whose points cannot be made gives none.
std::map<std::string, double> known_errors(const Study& study, const StudyResults& results,
                                           const std::string& quantity);

}  // namespace underbody::cases
