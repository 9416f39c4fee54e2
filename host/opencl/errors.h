#pragma once

#include "opencl/opencl.h"

#include <string>

namespace tristim {

/// "CL_OUT_OF_RESOURCES" for -5, and so on; "CL error -9999" for codes unknown to OpenCL 1.2.
std::string opencl_error_name(cl_int code);

/// One sentence for the user: the call, the CL_… code, and what can be done about it.
std::string describe_opencl_error(const ::cl::Error& error);

/// What went wrong, of the exception that is being handled, which derives from std::exception.
std::string describe_current_exception();

} // namespace tristim
