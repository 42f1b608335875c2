#pragma once
#include <stdint.h>
struct orb_metadata;
extern const orb_metadata __orb_distance_sensor;
struct distance_sensor_s {
    uint64_t timestamp; float current_distance;
};
