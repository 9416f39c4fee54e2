#include "opencl/errors.h"

#include <fmt/format.h>

#include <map>
#include <new>

namespace tristim {
namespace {

const std::map<cl_int, const char*>& error_names() {
#define NAMED(code)                                                                                                    \
    { code, #code }
    static const std::map<cl_int, const char*> names{
        NAMED(CL_DEVICE_NOT_FOUND),
        NAMED(CL_DEVICE_NOT_AVAILABLE),
        NAMED(CL_COMPILER_NOT_AVAILABLE),
        NAMED(CL_MEM_OBJECT_ALLOCATION_FAILURE),
        NAMED(CL_OUT_OF_RESOURCES),
        NAMED(CL_OUT_OF_HOST_MEMORY),
        NAMED(CL_PROFILING_INFO_NOT_AVAILABLE),
        NAMED(CL_MEM_COPY_OVERLAP),
        NAMED(CL_IMAGE_FORMAT_MISMATCH),
        NAMED(CL_IMAGE_FORMAT_NOT_SUPPORTED),
        NAMED(CL_BUILD_PROGRAM_FAILURE),
        NAMED(CL_MAP_FAILURE),
        NAMED(CL_MISALIGNED_SUB_BUFFER_OFFSET),
        NAMED(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST),
        NAMED(CL_COMPILE_PROGRAM_FAILURE),
        NAMED(CL_LINKER_NOT_AVAILABLE),
        NAMED(CL_LINK_PROGRAM_FAILURE),
        NAMED(CL_DEVICE_PARTITION_FAILED),
        NAMED(CL_KERNEL_ARG_INFO_NOT_AVAILABLE),
        NAMED(CL_INVALID_VALUE),
        NAMED(CL_INVALID_DEVICE_TYPE),
        NAMED(CL_INVALID_PLATFORM),
        NAMED(CL_INVALID_DEVICE),
        NAMED(CL_INVALID_CONTEXT),
        NAMED(CL_INVALID_QUEUE_PROPERTIES),
        NAMED(CL_INVALID_COMMAND_QUEUE),
        NAMED(CL_INVALID_HOST_PTR),
        NAMED(CL_INVALID_MEM_OBJECT),
        NAMED(CL_INVALID_IMAGE_FORMAT_DESCRIPTOR),
        NAMED(CL_INVALID_IMAGE_SIZE),
        NAMED(CL_INVALID_SAMPLER),
        NAMED(CL_INVALID_BINARY),
        NAMED(CL_INVALID_BUILD_OPTIONS),
        NAMED(CL_INVALID_PROGRAM),
        NAMED(CL_INVALID_PROGRAM_EXECUTABLE),
        NAMED(CL_INVALID_KERNEL_NAME),
        NAMED(CL_INVALID_KERNEL_DEFINITION),
        NAMED(CL_INVALID_KERNEL),
        NAMED(CL_INVALID_ARG_INDEX),
        NAMED(CL_INVALID_ARG_VALUE),
        NAMED(CL_INVALID_ARG_SIZE),
        NAMED(CL_INVALID_KERNEL_ARGS),
        NAMED(CL_INVALID_WORK_DIMENSION),
        NAMED(CL_INVALID_WORK_GROUP_SIZE),
        NAMED(CL_INVALID_WORK_ITEM_SIZE),
        NAMED(CL_INVALID_GLOBAL_OFFSET),
        NAMED(CL_INVALID_EVENT_WAIT_LIST),
        NAMED(CL_INVALID_EVENT),
        NAMED(CL_INVALID_OPERATION),
        NAMED(CL_INVALID_GL_OBJECT),
        NAMED(CL_INVALID_BUFFER_SIZE),
        NAMED(CL_INVALID_MIP_LEVEL),
        NAMED(CL_INVALID_GLOBAL_WORK_SIZE),
        NAMED(CL_INVALID_PROPERTY),
        NAMED(CL_INVALID_IMAGE_DESCRIPTOR),
        NAMED(CL_INVALID_COMPILER_OPTIONS),
        NAMED(CL_INVALID_LINKER_OPTIONS),
        NAMED(CL_INVALID_DEVICE_PARTITION_COUNT),
        {-1001, "CL_PLATFORM_NOT_FOUND_KHR"},
    };
#undef NAMED
    return names;
}

const char* advice(cl_int code) {
    switch (code) {
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
    case CL_OUT_OF_RESOURCES:
    case CL_OUT_OF_HOST_MEMORY:
    case CL_INVALID_BUFFER_SIZE:
        return "the device has too little memory; lower --resolution or --photons, or use a method with fewer "
               "wavelengths";
    case CL_DEVICE_NOT_AVAILABLE:
        return "another device may work: see 'tristim devices'";
    case -1001:
        return "no OpenCL platform is installed; on Debian: apt install pocl-opencl-icd";
    default:
        return "see 'tristim devices' for other devices";
    }
}

} // namespace

std::string opencl_error_name(cl_int code) {
    const auto found = error_names().find(code);
    return found != error_names().end() ? found->second : fmt::format("CL error {}", code);
}

std::string describe_opencl_error(const ::cl::Error& error) {
    return fmt::format("OpenCL call {} failed with {}: {}", error.what(), opencl_error_name(error.err()),
                       advice(error.err()));
}

std::string describe_current_exception() {
    try {
        throw;
    } catch (const ::cl::Error& error) {
        return describe_opencl_error(error);
    } catch (const std::bad_alloc&) {
        return "out of memory";
    } catch (const std::exception& error) {
        return error.what();
    }
}

} // namespace tristim
