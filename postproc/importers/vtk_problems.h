// What a VTK reader complains of becomes text for an error of ours, and does not reach the terminal.
#pragma once

#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkObject.h>
#include <vtkSmartPointer.h>

#include <string>

namespace underbody::postproc {

class VtkProblems {
public:
    explicit VtkProblems(vtkObject& reader) : command_(vtkSmartPointer<vtkCallbackCommand>::New()) {
        command_->SetClientData(this);
        command_->SetCallback([](vtkObject*, unsigned long, void* self, void* text) {
            static_cast<VtkProblems*>(self)->note(static_cast<const char*>(text));
        });
        reader.AddObserver(vtkCommand::ErrorEvent, command_);
    }
    ~VtkProblems() {
        command_->SetClientData(nullptr);
        command_->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
    }
    VtkProblems(const VtkProblems&) = delete;
    VtkProblems& operator=(const VtkProblems&) = delete;

    [[nodiscard]] bool any() const { return !first_.empty(); }
    /// The first complaint, without VTK's place in its source.
    [[nodiscard]] std::string first() const { return first_.empty() ? "no reason given" : first_; }

private:
    void note(const char* text) {
        if (first_.empty()) {
            first_ = text != nullptr ? text : "unknown";
            const std::size_t colon = first_.find("): ");
            first_ = colon == std::string::npos ? first_ : first_.substr(colon + 3);
            first_ = first_.substr(0, first_.find('\n'));
            first_ = first_.empty() ? "unknown" : first_;
        }
    }
    vtkSmartPointer<vtkCallbackCommand> command_;
    std::string first_;
};

}  // namespace underbody::postproc
