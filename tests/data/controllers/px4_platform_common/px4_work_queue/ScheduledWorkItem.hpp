#pragma once
#include <stdint.h>
namespace px4 {
struct wq_config_t {};
namespace wq_configurations {
extern const wq_config_t nav_and_controllers;
}
class ScheduledWorkItem {
public:
    void ScheduleOnInterval(uint32_t interval_us, uint32_t delay_us = 0);

protected:
    ScheduledWorkItem(const char* name, const wq_config_t& config);
    virtual ~ScheduledWorkItem();

private:
    virtual void Run() = 0;
};
}  // namespace px4
