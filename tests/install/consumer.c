/* Compiled against an install tree: motiongan.h and libmotiongan.so. */
#include <motiongan.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  motiongan_model model = 0;
  const motiongan_status status = motiongan_model_open("no such file", NULL, &model);
  printf("consumer in C: version %s, %s: %s\n", motiongan_version(), motiongan_status_name(status),
         motiongan_last_error());
  return status == MOTIONGAN_FAILED && strstr(motiongan_last_error(), "no such file") != NULL ? 0 : 1;
}
