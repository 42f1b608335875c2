// An error of an importer, with what it had understood of the file before.
#pragma once

#include <string>

#include "core/error.h"

namespace underbody::postproc {

/// Thrown by `read_field` for every fault in a file's content. The message ends with what was understood.
class ImportError : public core::InputError {
public:
    ImportError(const core::InputError& error, std::string understood)
        : core::InputError(error.kind(), error.message() + "; understood so far: " + understood, error.place(),
                           error.hint()),
          understood_(std::move(understood)) {}

    /// "12 sections, nodes 8 of 8, faces 0 of 24, cells 0 of 5, zones hull, ground"
    [[nodiscard]] const std::string& understood() const { return understood_; }

private:
    std::string understood_;
};

/// A file that does not say in which unit something is that the loads rest on: whoever knows it can say it
/// (ReadOptions::length_unit, ReadOptions::units).
class UnitMissing : public core::InputError {
public:
    /// `variable`: as the file names it, empty for the coordinates; `unit`: an SI unit of its kind.
    UnitMissing(const std::string& message, core::Place place, const std::string& hint, std::string variable,
                std::string unit)
        : core::InputError("unit", message, std::move(place), hint),
          variable_(std::move(variable)),
          unit_(std::move(unit)) {}

    [[nodiscard]] const std::string& variable() const { return variable_; }
    [[nodiscard]] const std::string& unit() const { return unit_; }

private:
    std::string variable_, unit_;
};

}  // namespace underbody::postproc
