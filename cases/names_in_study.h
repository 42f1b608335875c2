// What results say of files: their paths in the study, wherever that lies.
#pragma once

#include "cases/engine.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::cases {

inline void name_in_study(const Engine& engine, core::Problems& problems) {
    for (auto& problem : problems) {
        if (!problem.place.file.empty()) {
            problem.place.file = engine.path_in_study(problem.place.file);
        }
    }
}

/// `file`: where the model was read.
inline dynamics::Model named_in_study(const Engine& engine, dynamics::Model model, const std::filesystem::path& file) {
    model.name = engine.path_in_study(file);
    name_in_study(engine, model.remarks);
    return model;
}

inline dynamics::Measurements named_in_study(const Engine& engine, dynamics::Measurements data) {
    if (data.title.empty()) {
        data.title = engine.path_in_study(data.folder);
    }
    name_in_study(engine, data.problems);
    return data;
}

}  // namespace underbody::cases
