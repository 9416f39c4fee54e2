#include "test_device.h"

namespace tristim::test {

const Device& test_device() {
    // Never destroyed: at the end of the process an OpenCL implementation may be gone before it.
    static const Device& device = *new Device(open_device(""));
    return device;
}

} // namespace tristim::test
