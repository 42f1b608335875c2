// A formula of theory as a thing that can be listed, asked with units, checked against its limits and shown as text or
// JSON. The rooms that own the physics give lists of them.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/units.h"

namespace underbody::core {

struct ClosedForm {
    struct Input {
        std::string name;
        std::string unit;  ///< SI; "1" for a pure number
        std::string meaning;
        std::optional<double> usual;  ///< taken when nothing is given; without one it must be given
    };
    struct Output {
        std::string name;
        std::string unit;  ///< SI
        double value = 0;
        std::string meaning;
    };
    /// What the formula leaves out, and whether that may be left out here.
    struct Limit {
        std::string text;
        bool holds = true;
    };
    struct Result {
        std::vector<Output> outputs;
        std::vector<Limit> limits;
        /// All limits hold.
        [[nodiscard]] bool valid() const;
        /// Throws std::out_of_range when there is no output of that name.
        [[nodiscard]] double operator[](const std::string& name) const;
    };
    /// The values of the inputs, SI, one each.
    class Values {
    public:
        void set(const std::string& name, double value) { values_.push_back({name, value}); }
        /// Throws std::out_of_range for a name that is no input.
        [[nodiscard]] double operator()(const std::string& name) const;
        [[nodiscard]] const std::vector<NamedValue>& all() const { return values_; }

    private:
        std::vector<NamedValue> values_;
    };

    std::string name;     ///< one word, "slider"
    std::string summary;  ///< one line
    std::string formula;  ///< as people write it
    std::string source;   ///< author and year, or where it is derived
    std::vector<Input> inputs;
    std::function<Result(const Values&)> evaluate;
};

/// "inlet=2mm, outlet=1mm": the named inputs with their units (a bare number is SI), the usual values for the others.
/// Throws UsageError: an unknown name (with the nearest), one given twice, one that must be given and is not, a unit of
/// another dimension, a value that is not finite.
ClosedForm::Values closed_form_values(const ClosedForm& form, const std::vector<std::string>& given);

/// Throws UsageError with the nearest name when the list has none of that name.
const ClosedForm& find_closed_form(const std::vector<ClosedForm>& all, const std::string& name);

/// Inputs, results, formula, source and limits, a line each.
std::string closed_form_text(const ClosedForm& form, const ClosedForm::Values& values,
                             const ClosedForm::Result& result);

/// Keys `theory`, `summary`, `formula`, `source`, `inputs` {NAME: value}, `values` {NAME: value}, `results` [{`name`,
/// `value`, `unit`, `meaning`}], `limits` [{`text`, `holds`}], `valid`. SI.
nlohmann::json closed_form_json(const ClosedForm& form, const ClosedForm::Values& values,
                                const ClosedForm::Result& result);

}  // namespace underbody::core
