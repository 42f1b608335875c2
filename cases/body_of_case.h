// Whether the body in the file of a case is the shape that the study gives it.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "cases/study.h"
#include "core/error.h"
#include "geometry/body/body_shape.h"

namespace underbody::cases {

/// The [[body]] that a case is of by its words (variant = "ellipse": of its name, or that of its file); nullptr: none.
const BodySpec* body_of(const Study& study, const Case& entry);

/// The shapes of a study, each read once.
class BodiesOfCases {
public:
    explicit BodiesOfCases(const Study& study) : study_(study) {}

    /// A warning where length or height of the body in the file (CaseLoads) is not that of the shape: one that was
    /// changed after its CFD, or a file of another one. Nothing for a case of no shape, one whose file names zones that
    /// may be a part of the body, or one without loads.
    [[nodiscard]] std::optional<core::Problem> fault(const CaseLoads& loads);

private:
    const geometry::BodyShape* shape_of(const BodySpec& body);
    const Study& study_;
    std::map<const BodySpec*, std::optional<geometry::BodyShape>> shapes_;
};

/// No case with loads of a [[body]] of that name has such a fault.
bool is_of_its_cases(const Study& study, const StudyResults& results, const std::string& body);

}  // namespace underbody::cases
