// The declared numbers of a model file, once: for reading, checking, listing and changing by name.
#pragma once

#include <vector>

#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

struct ModelItem {
    const char* section;  ///< "vehicle", "drag.heave", ...
    const char* key;
    const char* unit;
    double lower, upper;
    bool required;
    double& (*of)(Model&);
    const char* meaning;
    const char* hint;  ///< what a value out of range most likely is
};

const std::vector<ModelItem>& model_items();

/// Throws core::InputError (kind "range") when a declared value cannot be.
void check_item(const ModelItem& item, double value, const core::Place& place);

/// Checks that go over several values: inertia, plausible density, contact. Throws or adds remarks.
void check_model(Model& model, const core::TomlTable& root);

}  // namespace underbody::dynamics
