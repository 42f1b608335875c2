#include "surrogates/dynamics/exports/motion_description.h"

#include <algorithm>

#include "core/text.h"

namespace underbody::dynamics {

namespace {

class Description {
public:
    Description(const MotionSource& of, const std::string& name, const std::string& guid)
        : of_(of), name_(name), guid_(guid) {}

    std::string text() {
        variables();
        std::string xml = head();
        xml += "  <UnitDefinitions>\n";
        for (const std::string& unit : units_) {
            xml += "    <Unit name=\"" + core::escape_html(unit) + "\"/>\n";
        }
        xml += "  </UnitDefinitions>\n  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  </LogCategories>\n";
        xml += "  <DefaultExperiment startTime=\"0\" stopTime=\"60\" tolerance=\"1e-10\"/>\n  <ModelVariables>\n" +
               xml_ + "  </ModelVariables>\n";
        return xml + structure() + "</fmiModelDescription>\n";
    }

private:
    [[nodiscard]] std::string head() const {
        std::string about = "Motion in " + fmu_motions()[static_cast<std::size_t>(of_.motion)] + " of " +
                            of_.model.name + " by Underbody; SI, gap, forces and pitch positive up and nose up";
        for (const core::Problem& remark : of_.fmu.remarks) {
            about += ". " + remark.message;
        }
        std::string xml =
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"" + name_ +
            "\" guid=\"" + guid_ + "\" description=\"" + core::escape_html(about) +
            "\" generationTool=\"Underbody\" variableNamingConvention=\"structured\" "
            "numberOfEventIndicators=\"" +
            (of_.motion == FmuMotion::heave ? "1" : "2") + "\">\n";
        const bool late = of_.vertical.terms.actuator.delay > 0;  // a simulator has to say which steps it took
        for (const char* kind : {"ModelExchange", "CoSimulation"}) {
            xml += std::string("  <") + kind + " modelIdentifier=\"" + name_ +
                   "\" providesDirectionalDerivative=\"true\" canGetAndSetFMUstate=\"true\" "
                   "canSerializeFMUstate=\"true\"" +
                   (kind[0] == 'C' ? " canHandleVariableCommunicationStepSize=\"true\" canInterpolateInputs=\"true\""
                    : late         ? ""
                                   : " completedIntegratorStepNotNeeded=\"true\"") +
                   ">\n    <SourceFiles>\n      <File name=\"fmu.c\"/>\n    </SourceFiles>\n  </" + kind + ">\n";
        }
        return xml;
    }

    void variable(const std::string& name, const std::string& meaning, const std::string& attributes,
                  const std::string& unit, const std::string& real) {
        xml_ += "    <ScalarVariable name=\"" + name + "\" valueReference=\"" + std::to_string(count_++) +
                "\" description=\"" + core::escape_html(meaning) + "\" " + attributes + ">\n      <Real unit=\"" +
                core::escape_html(unit) + "\"" + real + "/>\n    </ScalarVariable>\n";
        if (std::find(units_.begin(), units_.end(), unit) == units_.end()) {
            units_.push_back(unit);
        }
    }

    void variables() {
        const MotionFmu& fmu = of_.fmu;
        const auto start = [](double value) { return " start=\"" + core::format_number(value) + "\""; };
        for (const MotionFmuVariable& one : fmu.inputs) {
            variable(one.name, one.meaning, "causality=\"input\" variability=\"continuous\"", one.unit,
                     start(one.start));
        }
        for (std::size_t i = 0; i < fmu.states.size(); ++i) {
            const MotionFmuVariable& one = fmu.states[i];
            const bool given = i < fmu.start_states;
            variable(one.name, one.meaning,
                     std::string("causality=\"") + (given ? "output" : "local") +
                         "\" variability=\"continuous\" initial=\"" + (given ? "exact" : "calculated") + "\"",
                     one.unit, given ? start(one.start) : "");
        }
        for (std::size_t i = 0; i < fmu.states.size(); ++i) {
            const MotionFmuVariable& one = fmu.states[i];
            variable("der(" + one.name + ")", "its rate", "causality=\"local\" variability=\"continuous\"",
                     one.unit == "1" ? "1/s" : one.unit + "/s",
                     " derivative=\"" + std::to_string(fmu.inputs.size() + i + 1) + "\"");
        }
        for (const MotionFmuVariable& one : fmu.outputs) {
            const bool flag = one.name == "contact" || one.name == "outside_table";
            variable(one.name, one.meaning,
                     std::string("causality=\"output\" variability=\"") + (flag ? "discrete" : "continuous") + "\"",
                     one.unit, "");
        }
    }

    [[nodiscard]] std::string structure() const {
        const MotionFmu& fmu = of_.fmu;
        const std::size_t first_state = fmu.inputs.size() + 1, first_rate = first_state + fmu.states.size(),
                          first_output = first_rate + fmu.states.size();
        const auto unknowns = [](std::size_t from, std::size_t many) {
            std::string list;
            for (std::size_t i = from; i < from + many; ++i) {
                list += "      <Unknown index=\"" + std::to_string(i) + "\"/>\n";
            }
            return list;
        };
        const std::size_t given = fmu.start_states, left = fmu.states.size() - given;
        return "  <ModelStructure>\n    <Outputs>\n" + unknowns(first_state, given) +
               unknowns(first_output, fmu.outputs.size()) + "    </Outputs>\n    <Derivatives>\n" +
               unknowns(first_rate, fmu.states.size()) + "    </Derivatives>\n    <InitialUnknowns>\n" +
               unknowns(first_state + given, left) + unknowns(first_rate, fmu.states.size()) +
               unknowns(first_output, fmu.outputs.size()) + "    </InitialUnknowns>\n  </ModelStructure>\n";
    }

    const MotionSource& of_;
    const std::string &name_, &guid_;
    std::string xml_;
    std::vector<std::string> units_;
    std::size_t count_ = 0;
};

}  // namespace

std::string motion_description(const MotionSource& source, const std::string& name, const std::string& guid) {
    return Description(source, name, guid).text();
}

}  // namespace underbody::dynamics
