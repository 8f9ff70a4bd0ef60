/* Jumps where there is no program. */
#include <avr/io.h>

int main(void) {
    void (*volatile nowhere)(void) = (void (*)(void))0x3000;
    nowhere();
    return 0;
}
