#pragma once

namespace tristim {

/// From now on the first SIGINT or SIGTERM only sets interrupted(); a second one ends the process as usual.
void catch_interrupts();
bool interrupted();

} // namespace tristim
