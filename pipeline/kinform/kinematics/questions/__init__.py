"""Questions of users about freedoms and joints."""
