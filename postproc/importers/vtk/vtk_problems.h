// What a VTK reader complains of becomes text for an error of ours, and does not reach the terminal.
#pragma once

#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <string>

namespace underbody::postproc {

/// While one lives, VTK's complaints (of a reader and of the readers that it uses) are kept instead of shown.
class VtkProblems {
public:
    VtkProblems()
        : window_(vtkSmartPointer<Window>::New()),
          before_(vtkOutputWindow::GetInstance()),
          verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
        vtkOutputWindow::SetInstance(window_);
        vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    }
    ~VtkProblems() {
        vtkLogger::SetStderrVerbosity(verbosity_);
        vtkOutputWindow::SetInstance(before_);
    }
    VtkProblems(const VtkProblems&) = delete;
    VtkProblems& operator=(const VtkProblems&) = delete;

    [[nodiscard]] bool any() const { return !window_->first.empty(); }
    /// The first complaint, without VTK's place in its source.
    [[nodiscard]] std::string first() const { return any() ? window_->first : "no reason given"; }

private:
    class Window : public vtkOutputWindow {
    public:
        static Window* New() { VTK_STANDARD_NEW_BODY(Window); }
        void DisplayText(const char* /*text*/) override {}
        // Some readers only warn of data that end too early.
        void DisplayWarningText(const char* text) override { note_if_error(text); }
        void DisplayGenericWarningText(const char* text) override { note_if_error(text); }
        void DisplayErrorText(const char* text) override { note(text); }
        std::string first;

    private:
        void note_if_error(const char* text) {
            const std::string whole = text != nullptr ? text : "";
            if (whole.find("rror") != std::string::npos || whole.find("end of file") != std::string::npos) {
                note(text);
            }
        }
        void note(const char* text) {
            if (!first.empty()) {
                return;
            }
            first = text != nullptr ? text : "unknown";
            const std::size_t colon = first.find("): ");
            first = colon == std::string::npos ? first : first.substr(colon + 3);
            first = first.substr(0, first.find('\n'));
            first = first.empty() ? "unknown" : first;
        }
    };
    vtkSmartPointer<Window> window_;
    vtkSmartPointer<vtkOutputWindow> before_;
    vtkLogger::Verbosity verbosity_;
};

}  // namespace underbody::postproc
